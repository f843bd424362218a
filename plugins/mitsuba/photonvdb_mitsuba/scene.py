"""Scenes: a Mitsuba scene as photonvdb's scene file."""

from pathlib import Path

import mitsuba as mi

from .body import body_of, check_apart
from .camera import camera_table, check_view
from .errors import UnsupportedError
from .lights import light_table
from .medium import medium_table


def scene_file(scene, sensor, directory) -> dict:
    """A scene as photonvdb's dict, without settings; grids and images are written into ``directory``.

    Raises UnsupportedError, which names what photonvdb cannot render.
    """
    check_variant()
    directory = Path(directory)
    camera = camera_table(sensor)
    lights = [light_table(emitter, directory, number) for number, emitter in enumerate(free_emitters(scene))]
    bodies = [body_of(shape) for shape in scene.shapes()]
    if not bodies:
        raise UnsupportedError("the scene has no medium; photonvdb renders cubes and spheres with a medium inside")
    check_apart(bodies)
    check_view(sensor, bodies)
    media = [medium_table(body, directory, number) for number, body in enumerate(bodies)]
    return {"camera": camera, "medium": media, "light": lights}


def check_variant():
    """Refuses variants of other colours than RGB."""
    if not mi.variant().endswith("_rgb"):
        raise UnsupportedError(
            f"the variant {mi.variant()} is not supported; photonvdb renders RGB: set an rgb variant"
        )


def free_emitters(scene) -> list:
    """The emitters that belong to no shape: those of shapes are refused with their shape."""
    return [emitter for emitter in scene.emitters() if emitter.get_shape() is None]
