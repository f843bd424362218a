"""Grids for tests, as Mitsuba has them: (z, y, x, channel), zeros in the outermost voxels."""

import mitsuba as mi
import numpy as np


def blob(x_count=16, y_count=24, z_count=20):
    """A lump of smoke, of another shape along each axis."""
    x, y, z = ((np.arange(count) + 0.5) / count * 2 - 1 for count in (x_count, y_count, z_count))
    x, y, z = x[None, None, :], y[None, :, None], z[:, None, None]
    lump = np.exp(-3 * ((1.2 * x) ** 2 + 2 * (y - 0.2) ** 2 + 1.5 * z**2)) * (1 + 0.8 * np.sin(9 * x) * np.cos(7 * y))
    return with_zeros_around(lump)[..., None].astype(np.float32)


def with_zeros_around(array):
    """The array with its outermost voxels 0."""
    inside = np.zeros_like(array)
    inside[1:-1, 1:-1, 1:-1] = array[1:-1, 1:-1, 1:-1]
    return inside


def gridvolume(array, to_world=None, **more):
    """A gridvolume that fills a cube of Mitsuba, from -1 to 1 in each axis, under ``to_world``."""
    place = mi.ScalarTransform4f().translate(-1).scale(2)
    return {
        "type": "gridvolume",
        "grid": mi.VolumeGrid(array),
        "to_world": place if to_world is None else to_world @ place,
        **more,
    }


def sky():
    """An image of a sky with a low sun."""
    v, u = np.linspace(0, 1, 16)[:, None, None], np.linspace(0, 1, 32, endpoint=False)[None, :, None]
    sun = 20 * np.exp(-(60 * (u - 0.3) ** 2 + 40 * (v - 0.3) ** 2))
    blue, ground, yellow = (np.array(color) for color in ([0.4, 0.6, 1.0], [0.5, 0.3, 0.1], [1.0, 0.9, 0.6]))
    return mi.Bitmap((blue * (1 - v) + ground * v + sun * yellow).astype(np.float32))
