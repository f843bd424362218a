"""Blackbody emission of Principled Volume as media that glow: Cycles' is no matter of density, and so a flame to the library.

Of intensity b, tint c and a temperature of T kelvin, Cycles adds an emissivity [W/(m^3 sr)] of

    c 1e-6 sigma / pi (1 - b + b T^4) color(T)

where sigma is Stefan and Boltzmann's constant and color(T) the linear Rec.709 colour of a blackbody of luminance 1 (that of 800 K
below, of 12000 K above). Channels outside of the gamut are 0 here, which Cycles lets be negative. A flame has one colour and a grid of
numbers: three volumes, of red, green and blue, make up any colour. Blender 4 interpolates temperatures, the library emissivities, which
rise more steeply: they are kept in voxels of half the size. Blender 5 takes one of the voxels around at random, whose mean is that of
emissivities.
"""

import os
from functools import lru_cache
from math import pi

import bpy
import numpy as np
import photonvdb

STEFAN_BOLTZMANN = 5.670374e-8

#: From CIE XYZ to Rec.709.
XYZ_TO_RGB = np.array(
    ((3.2404542, -1.5371385, -0.4985314), (-0.9692660, 1.8760108, 0.0415560), (0.0556434, -0.2040259, 1.0572252))
)
COLDEST, HOTTEST = 800.0, 12000.0


def media(blackbody, place, density_change, directory):
    """Media of a file's transform whose flames are a blackbody: (intensity, tint, kelvin where the grid is 1, grid)."""
    intensity, tint, kelvin, grid = blackbody
    values, index_to_world, origin = photonvdb.read_vdb(place["file"], grid)
    if bpy.app.version < (5, 0):
        values, index_to_world, origin = refined(values, index_to_world, origin)
    emissivity = emissivities(np.maximum(values, 0.0) * kelvin, intensity)
    found = []
    for channel, share in enumerate(tint):
        glow = emissivity[..., channel]
        if share <= 0.0 or not glow.any():
            continue
        file = os.path.join(directory, f"blackbody.{len(os.listdir(directory))}.vdb")
        photonvdb.write_vdb(file, glow, index_to_world, origin, name="flame", class_="fog volume")
        color = [share * density_change if index == channel else 0.0 for index in range(3)]
        keys = {"file": file, "density": "flame", "density_scale": 0.0, "albedo": 0.0, "flame": "flame", "flame_color": color}
        found.append(place | keys)
    return found


def refined(values, index_to_world, origin):
    """The same grid, 0 outside, interpolated to voxels of half the size."""
    values = np.pad(values, 1)
    for axis in range(3):
        ahead = np.moveaxis(values, axis, 0)
        finer = np.empty((2 * len(ahead) - 1, *ahead.shape[1:]), np.float32)
        finer[::2] = ahead
        finer[1::2] = 0.5 * (ahead[:-1] + ahead[1:])
        values = np.moveaxis(finer, 0, axis)
    return values, index_to_world @ np.diag((0.5, 0.5, 0.5, 1.0)), tuple(2 * (index - 1) for index in origin)


def emissivities(kelvin, intensity):
    """Emissivity a channel, where tint is 1."""
    power = 1e-6 * STEFAN_BOLTZMANN / pi * (1.0 - intensity + intensity * kelvin.astype(np.float64) ** 4)
    kelvins, colors = color_table()
    channels = [np.interp(kelvin, kelvins, colors[:, channel]) for channel in range(3)]
    return (np.stack(channels, axis=-1) * np.maximum(power, 0.0)[..., None]).astype(np.float32)


@lru_cache(maxsize=1)
def color_table():
    """Temperatures, and the colours of blackbodies of luminance 1."""
    kelvin = np.geomspace(COLDEST, HOTTEST, 256)
    xyz = photonvdb.blackbody_xyz(kelvin)
    colors = (xyz / xyz[:, 1:2]) @ XYZ_TO_RGB.T
    return kelvin, np.maximum(colors, 0.0)
