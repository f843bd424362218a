"""Settings: what may stand in the dict of the integrator, and where it goes. The library checks the values."""

import difflib

from .errors import UnsupportedError

#: Arguments of ``photonvdb.render``.
ARGUMENTS = (
    "photons", "passes", "target_error", "time_budget", "gather", "k", "divisor", "emission", "threads",
)  # fmt: skip

#: Keys of the scene file, with their sections.
KEYS = {
    "max_order": "photons",
    "kernel": "estimate",
    "max_radius": "estimate",
    "march_samples": "render",
    "light_samples": "render",
    "lattice": "render",
    "bounces": "render",
    "filter": "render",
    "photons_only": "render",
}

#: What is not photonvdb's: extra layers, and whether environments are seen.
OWN = ("aovs", "hide_emitters")

#: Layers of an image that can be had as AOVs.
LAYERS = ("single_scatter", "multiple_scatter", "emission", "transmittance")


class Settings:
    """What a scene says of the integrator."""

    def __init__(self, props):
        given = {name: props[name] for name in props.keys()}
        for name in given:
            check_name(name)
        self.layers = layer_names(given.pop("aovs", ""))
        self.hides_emitters = bool(given.pop("hide_emitters", False))
        self.arguments = {name: value for name, value in given.items() if name in ARGUMENTS}
        self.keys = {name: value for name, value in given.items() if name in KEYS}

    def aov_names(self) -> list:
        """Channels beside the image's own."""
        return [f"{layer}.{channel}" for layer in self.layers for channel in "RGB"]

    def sections(self, samples_per_pixel: int) -> dict:
        """The sections of a scene file that say how it is rendered."""
        sections = {"render": {"samples_per_pixel": samples_per_pixel}}
        if self.hides_emitters:
            sections["render"]["background"] = "holdout"
        for name, value in self.keys.items():
            sections.setdefault(KEYS[name], {})[name] = value
        return sections


def check_name(name: str):
    """Refuses a name that means nothing here."""
    known = (*ARGUMENTS, *KEYS, *OWN)
    if name in known:
        return
    near = difflib.get_close_matches(name, known, n=1)
    meant = f'; did you mean "{near[0]}"?' if near else f"; known are {', '.join(known)}"
    raise UnsupportedError(f'integrator photonvdb: unknown property "{name}"{meant}')


def layer_names(aovs: str) -> list:
    """The layers of a list with commas between."""
    layers = [name.strip() for name in aovs.split(",") if name.strip()]
    for name in layers:
        if name not in LAYERS:
            raise UnsupportedError(f'integrator photonvdb: aovs: "{name}" is none of {", ".join(LAYERS)}')
    return layers
