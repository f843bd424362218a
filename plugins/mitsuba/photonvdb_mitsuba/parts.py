"""What Mitsuba's objects are made of: the objects inside one by name, its values, and what to call it."""

import mitsuba as mi
import numpy as np

from .errors import UnsupportedError


def children(thing) -> dict:
    """The objects inside an object, by the names that ``mi.traverse`` gives them."""

    # The base class is another one in every variant.
    class Children(mi.TraversalCallback):
        def __init__(self):
            super().__init__()
            self.found = {}

        def put(self, name, value, *_):
            if isinstance(value, mi.Object):
                self.found[name] = value

    callback = Children()
    thing.traverse(callback)
    return callback.found


def values(thing) -> dict:
    """The values of an object, by the names that ``mi.traverse`` gives them."""
    return mi.traverse(thing)


def number(value) -> float:
    """A number of any variant."""
    return float(np.asarray(value, dtype=np.float64).ravel()[0])


def numbers(value) -> list:
    """A vector, point or colour of any variant."""
    return np.asarray(value, dtype=np.float64).ravel().tolist()


def matrix(transform, owner: str) -> np.ndarray:
    """The 4 x 4 matrix of a transform of any variant, for column vectors; ``owner`` is whose it is, for an error."""
    forth, back = (np.asarray(way.matrix, dtype=np.float64).reshape(4, 4) for way in (transform, transform.inverse()))
    # Mitsuba keeps both, and takes the axis of a rotation as it is given.
    if np.abs((forth @ back)[:3, :3] - np.eye(3)).max() > 1e-3:
        raise UnsupportedError(f"{owner}: to_world and its inverse disagree; give rotations an axis of length 1")
    return forth


def described(kind: str, thing) -> str:
    """An object in the words of an error, for example ``emitter "lamp" (Projector)``."""
    name = f' "{thing.id()}"' if thing.id() else ""
    return f"{kind}{name} ({thing.class_name()})"
