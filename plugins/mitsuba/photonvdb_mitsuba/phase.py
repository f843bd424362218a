"""Phase functions; g > 0 is forward here and there."""

from .errors import UnsupportedError
from .parts import described, number, values


def phase_table(phase, owner: str) -> dict:
    """The ``phase`` of a medium."""
    kind = phase.class_name()
    if kind == "IsotropicPhaseFunction":
        return {"kind": "isotropic"}
    if kind == "HGPhaseFunction":
        return {"kind": "henyey-greenstein", "g": number(values(phase)["g"])}
    raise UnsupportedError(
        f"{owner}: {described('phase function', phase)} is not supported; there are isotropic and hg"
    )
