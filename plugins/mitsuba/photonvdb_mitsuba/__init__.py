"""photonvdb as an integrator of Mitsuba 3: importing this package makes ``{'type': 'photonvdb'}`` known.

It is registered for the variant that is set, and again whenever another one is set.
"""

from .errors import UnsupportedError
from .integrator import register
from .scene import scene_file

__all__ = ["UnsupportedError", "scene_file"]

register()
