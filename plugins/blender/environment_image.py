"""Images of Blender as OpenEXR files that the library reads: uncompressed, 32-bit floats, linear Rec.709."""

import os
import struct

import numpy as np

from .refusal import Refused

LINEAR = ("Linear Rec.709", "Linear", "scene_linear")


def write_exr(image, directory, name):
    """Writes an image's pixels, as scene-linear light, to a file of `directory`; returns its path."""
    width, height = image.size
    if width * height == 0:
        raise Refused(name, f'image "{image.name}" has no pixels')
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    # Rows from the bottom up, RGB or a grey.
    pixels = pixels.reshape(height, width, image.channels)[::-1, :, :3]
    # Blender turns images of floats into scene-linear light when it loads them, and leaves bytes as they are.
    color_space = image.colorspace_settings.name
    if not image.is_float and color_space == "sRGB":
        pixels = np.where(pixels <= 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4)
    elif not image.is_float and not image.colorspace_settings.is_data and color_space not in LINEAR:
        raise Refused(name, f'image "{image.name}" has bytes of colour space {color_space}')
    path = os.path.join(directory, f"environment.{len(os.listdir(directory))}.exr")
    with open(path, "wb") as file:
        file.write(exr_bytes(np.broadcast_to(np.maximum(pixels, 0.0), (height, width, 3))))
    return path


def exr_bytes(pixels):
    """An OpenEXR file of pixels (height, width, 3), the topmost row first."""
    height, width, _ = pixels.shape
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(name + struct.pack("<xi4x2i", 2, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    attributes = [
        (b"channels", b"chlist", channels),
        (b"compression", b"compression", b"\0"),
        (b"dataWindow", b"box2i", window),
        (b"displayWindow", b"box2i", window),
        (b"lineOrder", b"lineOrder", b"\0"),
        (b"pixelAspectRatio", b"float", struct.pack("<f", 1.0)),
        (b"screenWindowCenter", b"v2f", struct.pack("<2f", 0.0, 0.0)),
        (b"screenWindowWidth", b"float", struct.pack("<f", 1.0)),
    ]
    header = struct.pack("<2i", 20000630, 2)
    header += b"".join(name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value for name, kind, value in attributes)
    header += b"\0"
    # A row is its number, its length, then all of B, of G and of R.
    rows = np.ascontiguousarray(pixels[:, :, ::-1].transpose(0, 2, 1), "<f4").reshape(height, -1)
    length = rows.shape[1] * 4
    first = len(header) + 8 * height
    offsets = first + np.arange(height, dtype="<u8") * np.uint64(8 + length)
    lines = np.empty((height, 8 + length), np.uint8)
    lines[:, :4] = np.arange(height, dtype="<i4").reshape(-1, 1).view(np.uint8)
    lines[:, 4:8] = np.full((height, 1), length, "<i4").view(np.uint8)
    lines[:, 8:] = rows.view(np.uint8)
    return header + offsets.tobytes() + lines.tobytes()
