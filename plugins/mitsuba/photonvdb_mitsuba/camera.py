"""The camera: Mitsuba's perspective sensor as photonvdb's pinhole.

Mitsuba keeps the field of view along the image's width, photonvdb along its height: tan(v/2) = tan(x/2) height / width.
"""

import math

import numpy as np

from .errors import UnsupportedError
from .parts import described, matrix, number, numbers, values


def camera_table(sensor) -> dict:
    """The ``[camera]`` of a scene file, for the whole of the film: a crop is cut from the image."""
    name = described("sensor", sensor)
    if sensor.class_name() != "PerspectiveCamera":
        raise UnsupportedError(f"{name} is not supported; photonvdb has perspective cameras")
    known = values(sensor)
    for axis in "xy":
        if number(known[f"principal_point_offset_{axis}"]) != 0:
            raise UnsupportedError(f"{name}: principal_point_offset_{axis} is not supported; set it to 0")
    to_world = matrix(known["to_world"], name)
    if np.linalg.det(to_world[:3, :3]) < 0:
        raise UnsupportedError(f"{name}: to_world mirrors the image, which is not supported")
    width, height = (int(side) for side in numbers(sensor.film().size()))
    half_width = math.tan(math.radians(number(known["x_fov"])) / 2)
    position, forward, up = to_world[:3, 3], to_world[:3, 2], to_world[:3, 1]
    return {
        "position": position.tolist(),
        "look_at": (position + forward).tolist(),
        "up": up.tolist(),
        "vertical_fov": math.degrees(2 * math.atan(half_width * height / width)),
        "resolution": [width, height],
    }


def check_view(sensor, bodies):
    """Refuses a camera that does not see media whole: that is cut by its clipping planes, or unsure of where it stands.

    Mitsuba's rays start at the near plane, in the medium that the sensor names; photonvdb's start at the pinhole.
    """
    name = described("sensor", sensor)
    known = values(sensor)
    to_world = matrix(known["to_world"], name)
    position, forward = to_world[:3, 3], to_world[:3, 2]
    near, far = number(known["near_clip"]), number(known["far_clip"])
    for body in bodies:
        lowest, highest = body.bounds()
        size = float(np.linalg.norm(highest - lowest))
        middle = float(np.dot((lowest + highest) / 2 - position, forward))
        reach = float(np.dot((highest - lowest) / 2, np.abs(forward)))
        if middle + reach > far:
            raise UnsupportedError(f"{name}: far_clip cuts {body.name}; photonvdb sees to infinity: raise it")
        if near > max(middle - reach, 0.01 * size) and middle + reach > 0:
            raise UnsupportedError(f"{name}: near_clip cuts {body.name}; photonvdb sees from the pinhole: lower it")
    check_medium(sensor, [body.medium for body in bodies if body.contains(position[None])])


def check_medium(sensor, around: list):
    """Refuses a sensor that names another medium than the one it stands in."""
    name = described("sensor", sensor)
    medium = sensor.get_medium()
    if around and medium is None:
        raise UnsupportedError(
            f"{name} stands in {described('medium', around[0])} but does not name it; set its medium"
        )
    if medium is not None and medium not in around:
        raise UnsupportedError(
            f"{name} names {described('medium', medium)} but does not stand in it; remove its medium"
        )
