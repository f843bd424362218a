"""Bodies: the cubes and spheres that media fill.

A cube of Mitsuba is a mesh; where it lies is solved from its corners, which every cube has in the same order.
"""

from dataclasses import dataclass

import mitsuba as mi
import numpy as np

from .errors import UnsupportedError
from .parts import described, matrix, values

#: Share of a body's size that counts as nothing, for Mitsuba's single precision.
TOLERANCE = 1e-5


@dataclass
class Cube:
    """The image of the box from -1 to 1 under an affine map."""

    name: str
    medium: object
    to_world: np.ndarray

    def bounds(self):
        """Lowest and highest corner of the axis-aligned box around it."""
        middle, reach = self.to_world[:3, 3], np.abs(self.to_world[:3, :3]).sum(axis=1)
        return middle - reach, middle + reach

    def contains(self, points) -> bool:
        """Whether all points, of shape (n, 3), lie inside."""
        inside = np.linalg.solve(self.to_world[:3, :3], (points - self.to_world[:3, 3]).T)
        return bool(np.all(np.abs(inside) <= 1 + TOLERANCE))

    def bounds_table(self) -> dict:
        """The ``bounds`` of a homogeneous medium; a cube that is turned has none."""
        axes = np.abs(self.to_world[:3, :3])
        # Each column of a box's map has one number that counts, each in another row.
        leading = axes > TOLERANCE * axes.max(axis=0)
        if not (np.all(leading.sum(axis=0) == 1) and np.all(leading.sum(axis=1) == 1)):
            raise UnsupportedError(
                f"{self.name} is turned, which is not supported; homogeneous media fill axis-aligned cubes or spheres"
            )
        lowest, highest = self.bounds()
        return {"min": lowest.tolist(), "max": highest.tolist()}


@dataclass
class Ball:
    """A sphere."""

    name: str
    medium: object
    center: np.ndarray
    radius: float

    def bounds(self):
        """Lowest and highest corner of the axis-aligned box around it."""
        return self.center - self.radius, self.center + self.radius

    def contains(self, points) -> bool:
        """Whether all points, of shape (n, 3), lie inside."""
        distances = np.linalg.norm(points - self.center, axis=1)
        return bool(np.all(distances <= self.radius * (1 + TOLERANCE)))

    def bounds_table(self) -> dict:
        """The ``bounds`` of a homogeneous medium."""
        return {"center": self.center.tolist(), "radius": self.radius}


def body_of(shape):
    """The body of a shape: a cube or a sphere of no surface, with a medium inside."""
    name = described("shape", shape)
    if shape.is_emitter():
        raise UnsupportedError(
            f"{name} shines, which is not supported; lights are point, spot, directional, constant, envmap"
        )
    medium = shape.interior_medium()
    if medium is None:
        raise UnsupportedError(f"{name} has no medium inside; photonvdb renders media alone, not surfaces")
    if shape.bsdf() is None or shape.bsdf().class_name() != "Null":
        bsdf = described("BSDF", shape.bsdf()) if shape.bsdf() else "its default BSDF"
        raise UnsupportedError(f"{name}: {bsdf} is not supported; bodies of media have the BSDF null")
    if shape.exterior_medium() is not None:
        raise UnsupportedError(
            f"{name} has a medium outside, which is not supported; media are surrounded by empty space"
        )
    if shape.has_flipped_normals():
        raise UnsupportedError(f"{name} has flipped normals, and its medium outside, which is not supported")
    if shape.class_name() == "Sphere":
        to_world = matrix(values(shape)["to_world"], name)
        return Ball(name, medium, to_world[:3, 3], float(np.linalg.norm(to_world[:3, 0])))
    if shape.class_name() == "Cube":
        return Cube(name, medium, cube_to_world(shape, name))
    hint = "; scenes are loaded with optimize=False where Mitsuba merges cubes" if shape.is_mesh() else ""
    raise UnsupportedError(f"{name} is not supported; media fill cubes and spheres{hint}")


def cube_to_world(shape, name: str) -> np.ndarray:
    """The map of a cube, from where its corners lie."""
    corners, known = (
        np.asarray(values(cube)["vertex_positions"], dtype=np.float64).reshape(-1, 3)
        for cube in (shape, mi.load_dict({"type": "cube"}))
    )
    if corners.shape != known.shape:
        raise UnsupportedError(f"{name} has {len(corners)} vertices, where a cube has {len(known)}")
    columns, *_ = np.linalg.lstsq(np.c_[known, np.ones(len(known))], corners, rcond=None)
    to_world = np.eye(4)
    to_world[:3] = columns.T
    size = np.ptp(corners, axis=0).max()
    if np.abs(np.c_[known, np.ones(len(known))] @ columns - corners).max() > TOLERANCE * size:
        raise UnsupportedError(f"{name} is not a cube any more; its vertices were moved")
    if np.linalg.matrix_rank(to_world[:3, :3]) < 3:
        raise UnsupportedError(f"{name} is flat; a medium needs a volume")
    return to_world


def check_apart(bodies):
    """Refuses bodies that overlap: Mitsuba follows one medium at a time, where photonvdb adds them up."""
    for number, one in enumerate(bodies):
        for other in bodies[:number]:
            if overlap(one, other):
                raise UnsupportedError(f"{one.name} and {other.name} overlap, or nearly so; media have to lie apart")


def overlap(one, other) -> bool:
    """Whether two bodies overlap; of cubes and of a cube and a sphere, whether the boxes around them do."""
    if isinstance(one, Ball) and isinstance(other, Ball):
        reach = one.radius + other.radius
        return bool(np.linalg.norm(one.center - other.center) < reach * (1 - TOLERANCE))
    (low, high), (other_low, other_high) = one.bounds(), other.bounds()
    shared = np.minimum(high, other_high) - np.maximum(low, other_low)
    return bool(np.all(shared > TOLERANCE * np.maximum(high - low, other_high - other_low)))
