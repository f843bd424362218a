"""Lights: Mitsuba's emitters as ``[[light]]``. Intensity, irradiance and radiance mean the same here and there.

A spot falls linearly in the angle, from beam_width to cutoff_angle; both are half-angles.
"""

import numpy as np

from .color import constant_spectrum
from .environment import environment_table
from .errors import UnsupportedError
from .parts import children, described, matrix, number, numbers, values


def light_table(emitter, directory, number_of: int) -> dict:
    """One ``[[light]]``; an image is written into ``directory``."""
    name = described("emitter", emitter)
    kind = emitter.class_name()
    if kind not in (*READINGS, "EnvironmentMapEmitter"):
        raise UnsupportedError(f"{name} is not supported; lights are point, spot, directional, constant, envmap")
    if number(values(emitter)["sampling_weight"]) <= 0:
        raise UnsupportedError(f"{name} has a sampling_weight of 0, and is dark to Mitsuba; remove it")
    if kind == "EnvironmentMapEmitter":
        return environment_table(emitter, name, directory / f"light{number_of}.exr")
    return READINGS[kind](emitter, name)


def point(emitter, name: str) -> dict:
    """The same in all directions."""
    return {
        "kind": "point",
        "position": numbers(values(emitter)["position"]),
        "intensity": constant_spectrum(children(emitter)["intensity"], f"{name}: intensity"),
    }


def spot(emitter, name: str) -> dict:
    """A cone of light along +z of its own space."""
    known, parts = values(emitter), children(emitter)
    to_world = matrix(known["to_world"], name)
    texture = constant_spectrum(parts["texture"], f"{name}: texture")
    intensity = constant_spectrum(parts["intensity"], f"{name}: intensity")
    return {
        "kind": "spot",
        "position": to_world[:3, 3].tolist(),
        "look_at": (to_world[:3, 3] + to_world[:3, 2]).tolist(),
        "intensity": (np.array(texture) * intensity).tolist(),
        "cone_angle": number(known["cutoff_angle"]),
        "falloff_angle": number(known["beam_width"]),
    }


def directional(emitter, name: str) -> dict:
    """Parallel light along +z of its own space."""
    return {
        "kind": "directional",
        "direction": matrix(values(emitter)["to_world"], name)[:3, 2].tolist(),
        "irradiance": constant_spectrum(children(emitter)["irradiance"], f"{name}: irradiance"),
    }


def constant(emitter, name: str) -> dict:
    """The same radiance from all around."""
    return {
        "kind": "environment",
        "radiance": constant_spectrum(children(emitter)["radiance"], f"{name}: radiance"),
    }


READINGS = {
    "PointLight": point,
    "SpotLight": spot,
    "DirectionalEmitter": directional,
    "ConstantBackgroundEmitter": constant,
}
