"""What the integrator refuses, and how it says so."""


class UnsupportedError(ValueError):
    """Something of a Mitsuba scene that photonvdb cannot render, named in one sentence."""
