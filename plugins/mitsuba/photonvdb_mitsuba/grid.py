"""Grids: a gridvolume as an OpenVDB file.

A gridvolume of n voxels a side fills the unit cube of its own space, the middle of voxel i at (i + 1/2) / n, and is interpolated
trilinearly between them: OpenVDB's voxels at whole index coordinates, under index_to_world = to_world [1/n | 1/(2n)].
At the faces they differ: a gridvolume ends sharply, and an OpenVDB grid falls to its background within a voxel. Where the
outermost voxels are 0 both are 0 there, whatever the wrap mode is; other grids are refused.

Mitsuba tells neither filter nor wrap mode, and the transform in six digits only. So a trilinear grid is made of what was
read, and compared with the one given at points within its bounding box.
"""

import re

import mitsuba as mi
import numpy as np
import photonvdb

from .errors import UnsupportedError
from .parts import described, numbers, values

#: Points at which a grid is compared with its copy.
PROBES = 512

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


def write_grid(volume, body, path, owner: str):
    """Writes a gridvolume that lies within a body, after checking that photonvdb reads the same from it."""
    name = f"{owner}: {described('volume', volume)}"
    if volume.class_name() != "GridVolume":
        raise UnsupportedError(f"{name} is not supported; a heterogeneous medium has a gridvolume")
    tensor = np.asarray(values(volume)["data"], dtype=np.float32)
    if tensor.shape[3] != 1:
        raise UnsupportedError(f"{name} has {tensor.shape[3]} channels; extinction has one")
    to_world = grid_to_world(volume, name)
    check_copy(volume, tensor, to_world, name)
    array = tensor[..., 0].transpose(2, 1, 0)
    check_faces(array, name)
    index_to_world = to_world @ voxels_to_unit(array.shape)
    check_within(array, index_to_world, body, name)
    photonvdb.write_vdb(path, array, index_to_world)


def voxels_to_unit(shape) -> np.ndarray:
    """The map from index coordinates to the unit cube."""
    to_unit = np.diag([*(1 / side for side in shape), 1.0])
    to_unit[:3, 3] = [0.5 / side for side in shape]
    return to_unit


def grid_to_world(volume, name: str) -> np.ndarray:
    """The map from the unit cube to the world.

    Mitsuba prints it as the inverse transpose of ``to_local``. Of an axis-aligned grid its bounding box, which is exact,
    replaces the printed digits.
    """
    printed = re.search(rf"inverse_transpose=\[((?:[\s\[\],]|{NUMBER})*)\]", str(volume))
    digits = re.findall(NUMBER, printed.group(1)) if printed else []
    if len(digits) != 16:
        raise UnsupportedError(f"{name} does not say where it lies; this version of Mitsuba is not supported")
    to_world = np.array([float(digit) for digit in digits]).reshape(4, 4).T
    axes = to_world[:3, :3]
    if np.all((axes != 0).sum(axis=0) == 1) and np.all((axes != 0).sum(axis=1) == 1):
        lowest, highest = (np.array(numbers(corner)) for corner in (volume.bbox().min, volume.bbox().max))
        sign = np.sign(axes)
        to_world[:3, :3] = sign * (highest - lowest)[:, None]
        to_world[:3, 3] = np.where(sign.sum(axis=1) > 0, lowest, highest)
    return to_world


def check_copy(volume, tensor, to_world, name: str):
    """Refuses a grid that is interpolated in another way than photonvdb's grids are."""
    known = mi.load_dict(
        {
            "type": "gridvolume",
            "grid": mi.VolumeGrid(tensor),
            "to_world": mi.ScalarTransform4f(to_world.tolist()),
        }
    )
    low, high = (np.array(numbers(corner)) for corner in (volume.bbox().min, volume.bbox().max))
    points = low + np.random.default_rng(0).random((PROBES, 3)) * (high - low)
    given, copied = (values_at(grid, points) for grid in (volume, known))
    # Six digits of a place leave an error of as many digits of the largest value.
    if np.abs(given - copied).max() > 1e-3 * np.abs(tensor).max():
        raise UnsupportedError(
            f"{name} is not interpolated as photonvdb does: set its filter_type to trilinear, its wrap_mode to clamp, "
            "and give rotations in its to_world an axis of length 1"
        )


def values_at(volume, points) -> np.ndarray:
    """Values of a volume at points, of shape (n, 3)."""
    place = mi.Interaction3f()
    if not mi.variant().startswith("scalar"):
        place.p = mi.Point3f(points.T.astype(np.float32))
        return np.asarray(volume.eval_1(place), dtype=np.float64)
    seen = []
    for point in points.tolist():
        place.p = point
        seen.append(volume.eval_1(place))
    return np.array(seen)


def check_faces(array, name: str):
    """Refuses a grid that does not end in zeros."""
    for axis in range(3):
        if np.any(np.take(array, [0, -1], axis=axis) != 0):
            raise UnsupportedError(
                f"{name} is not 0 in its outermost voxels, where photonvdb would blur its edge; pad it with a layer of zeros"
            )


def check_within(array, index_to_world, body, name: str):
    """Refuses a grid that the body cuts."""
    filled = np.argwhere(array != 0)
    if len(filled) == 0:
        return
    # A voxel reaches to the middles of its neighbours.
    low, high = filled.min(axis=0) - 1, filled.max(axis=0) + 1
    corners = np.array([[x, y, z, 1] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    if not body.contains((corners @ index_to_world.T)[:, :3]):
        raise UnsupportedError(f"{body.name} cuts off a part of {name}, which is not supported; make it larger")
