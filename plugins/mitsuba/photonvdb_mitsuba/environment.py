"""Environment maps: Mitsuba's latitude-longitude image, which is interpolated between pixels and may be turned any way, as
photonvdb's, which has one value a pixel and +y up.

Mitsuba 3.9 puts the middle of column i at u = (i + 1/2) / width, with a copy of the last column before the first and of the
first behind the last, and row j at v = j / (height - 1), the first and last row at the poles. The image is drawn anew,
finer, each pixel with the interpolated value at its middle.
"""

import mitsuba as mi
import numpy as np

from .parts import matrix, number, values

#: Finer pixels a pixel, along each side, where the image is small.
FINER = 8

#: Columns of the finer image, at most, unless the image has more.
LARGEST = 2048


def environment_table(emitter, name: str, path) -> dict:
    """The ``[[light]]`` of an envmap, whose image is written to ``path``."""
    known = values(emitter)
    image = np.asarray(known["data"], dtype=np.float32)[..., :3]
    rows, columns = image.shape[0], image.shape[1] - 2
    width = max(min(FINER * columns, LARGEST), columns)
    height = max(min(FINER * rows, LARGEST // 2), rows)
    world_to_local = np.linalg.inv(matrix(known["to_world"], name)[:3, :3])
    finer = np.empty((height, width, 3), np.float32)
    for row in range(height):
        local = pixel_directions(row, width, height) @ world_to_local.T
        finer[row] = radiance(image, local / np.linalg.norm(local, axis=1, keepdims=True))
    mi.Bitmap(finer).write(str(path))
    return {"kind": "environment", "file": path.name, "scale": number(known["scale"])}


def pixel_directions(row: int, width: int, height: int) -> np.ndarray:
    """Directions through the middles of a row of photonvdb's pixels: row 0 is up (+y), the middle column looks along -z."""
    polar = np.pi * (row + 0.5) / height
    azimuth = 2 * np.pi * ((np.arange(width) + 0.5) / width - 0.5)
    ring = np.sin(polar)
    return np.c_[ring * np.sin(azimuth), np.full(width, np.cos(polar)), -ring * np.cos(azimuth)]


def radiance(image, directions) -> np.ndarray:
    """Values of Mitsuba's image in unit directions of its own space."""
    rows, columns = image.shape[0], image.shape[1] - 2
    u = np.arctan2(directions[:, 0], -directions[:, 2]) / (2 * np.pi) % 1.0
    v = np.arccos(np.clip(directions[:, 1], -1, 1)) / np.pi
    x, y = u * columns + 0.5, v * (rows - 1)
    left = np.minimum(x.astype(int), columns)
    top = np.minimum(y.astype(int), rows - 2)
    across, down = (x - left)[:, None], (y - top)[:, None]
    upper = image[top, left] * (1 - across) + image[top, left + 1] * across
    lower = image[top + 1, left] * (1 - across) + image[top + 1, left + 1] * across
    return upper * (1 - down) + lower * down
