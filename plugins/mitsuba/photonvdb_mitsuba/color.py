"""Colours: what a spectrum or a volume that is the same everywhere says in RGB."""

import mitsuba as mi

from .errors import UnsupportedError
from .parts import children, described, numbers


def constant_spectrum(spectrum, owner: str) -> list:
    """The RGB values of a spectrum that does not vary in space; ``owner`` is whose it is, for an error."""
    if spectrum.is_spatially_varying():
        raise UnsupportedError(f"{owner}: {described('texture', spectrum)} is not supported; give one number or colour")
    try:
        color = numbers(spectrum.eval(mi.SurfaceInteraction3f()))
    except RuntimeError as error:
        raise UnsupportedError(
            f"{owner}: {described('spectrum', spectrum)} has no RGB value; give one number or colour"
        ) from error
    return color if len(color) == 3 else color * 3


def constant_volume(volume, owner: str) -> list:
    """The RGB values of a volume that is the same everywhere."""
    if volume.class_name() != "ConstVolume":
        raise UnsupportedError(f"{owner}: {described('volume', volume)} is not supported; give one number or colour")
    return constant_spectrum(children(volume)["value"], owner)
