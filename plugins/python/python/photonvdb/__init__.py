"""Volumetric photon mapping of homogeneous and OpenVDB media, with its bias reported.

Scenes are dicts with the keys of a scene file, or paths of one; results are NumPy arrays. SI units, right-handed world space,
linear Rec.709. Equal seeds give equal arrays, for any number of threads.
"""

from ._photonvdb import (
    Error,
    PhotonMap,
    Rendering,
    __version__,
    bias,
    blackbody_xyz,
    compare,
    read_vdb,
    render,
    write_vdb,
)

__all__ = [
    "Error",
    "PhotonMap",
    "Rendering",
    "__version__",
    "bias",
    "blackbody_xyz",
    "compare",
    "read_vdb",
    "render",
    "write_vdb",
]
