"""What Mitsuba's objects are made of: the objects inside one by name, its values, and what to call it."""

import mitsuba as mi
import numpy as np


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


def matrix(transform) -> np.ndarray:
    """The 4 x 4 matrix of a transform of any variant, for column vectors."""
    return np.asarray(transform.matrix, dtype=np.float64).reshape(4, 4)


def described(kind: str, thing) -> str:
    """An object in the words of an error, for example ``emitter "lamp" (Projector)``."""
    name = f' "{thing.id()}"' if thing.id() else ""
    return f"{kind}{name} ({thing.class_name()})"
