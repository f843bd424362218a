"""Volumetric photon mapping of homogeneous and OpenVDB media, with its bias reported."""

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, Literal, Union, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = Union[str, os.PathLike[str]]
_Scene = Union[dict[str, Any], _Path]
_Progress = Callable[[str, float, int, Union[float, None]], object]
_Gather = Literal["auto", "lattice", "knn", "bounce"]
_Divisor = Literal["k", "k-1", "k-1/2", "calibrated"]
_Emission = Literal["random", "stratified", "sobol"]
_Layer = Literal["depth", "lights", "alpha", "photon_count", "kernel_radius", "variance"]

class Error(ValueError):
    """A scene, a volume or a value that photonvdb cannot work with, in one sentence."""

@final
class Rendering:
    """An image: its layers by name, and how it was made.

    Layers are float32, (height, width, channels) or (height, width), row 0 at the top.
    """

    @property
    def layers(self) -> dict[str, NDArray[np.float32]]:
        """The layers by name."""
    @property
    def report(self) -> dict[str, Any]:
        """How the image was made: the keys of ``photonvdb render --report``."""
    def write_exr(self, path: _Path, *, half: bool = False) -> None:
        """Writes the image with all its layers and settings as OpenEXR."""
    def write_png(self, path: _Path) -> None:
        """Writes a tone-mapped PNG for a quick look."""
    def keys(self) -> list[str]:
        """The names of the layers."""
    def __getitem__(self, name: str) -> NDArray[np.float32]: ...
    def __contains__(self, name: object) -> bool: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[str]: ...

def render(
    scene: _Scene,
    *,
    photons: float | None = None,
    passes: float | None = None,
    target_error: float | None = None,
    time_budget: float | None = None,
    gather: _Gather | None = None,
    k: float | None = None,
    divisor: _Divisor | None = None,
    emission: _Emission | None = None,
    seed: int | None = None,
    resolution: Sequence[int] | None = None,
    threads: int | None = None,
    progress: _Progress | None = None,
    layers: _Layer | Iterable[_Layer] | None = None,
    directory: _Path | None = None,
) -> Rendering:
    """Renders a scene: a dict with the keys of a scene file, or the path of one.

    Arguments other than None replace what the scene says. ``progress(stage, fraction, passes, error)`` is called as the render goes
    on; if it returns False the render ends after the pass in flight.
    """

@final
class PhotonMap:
    """A scene with its photon map. Places are in metres, in arrays of shape (..., 3); results have the same leading shape."""

    @staticmethod
    def build(
        scene: _Scene,
        *,
        photons: float | None = None,
        k: float | None = None,
        divisor: _Divisor | None = None,
        emission: _Emission | None = None,
        seed: int | None = None,
        photons_only: bool | None = None,
        threads: int | None = None,
        progress: _Progress | None = None,
        directory: _Path | None = None,
    ) -> PhotonMap:
        """Emits and traces the photons of a scene and builds their map; with ``photons_only`` light scattered once is in it, too."""
    def fluence(
        self, points: ArrayLike, k: float | None = None, divisor: _Divisor | None = None
    ) -> NDArray[np.float64]:
        """Fluence at places [W/m^2], of the photons in the map."""
    def power_density(
        self, points: ArrayLike, k: float | None = None, divisor: _Divisor | None = None
    ) -> NDArray[np.float64]:
        """Power density at places [W/m^3], of the photons in the map."""
    def radiance(
        self, origins: ArrayLike, directions: ArrayLike, t_max: ArrayLike | None = None, *, seed: int = 0
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Light along rays from up to ``t_max`` metres ahead [W/(m^2 sr)], and the transmittance of these segments."""
    @property
    def report(self) -> dict[str, Any]:
        """How the map was made: photons, power, seconds."""
    def __len__(self) -> int: ...

def bias(
    models: str | Iterable[str],
    n: float | None = None,
    k: float | Iterable[float] | None = None,
    trials: float = 10_000,
    divisors: str | Iterable[str] | None = None,
    seed: int = 0,
    *,
    method: Literal["fast", "direct"] = "fast",
    threads: int | None = None,
    progress: _Progress | None = None,
) -> dict[str, NDArray[Any]]:
    """Bias and variance of k-nearest estimates in models, exact and measured: columns of a table."""

def compare(
    scene: _Scene,
    *,
    k: float | Iterable[float] | None = None,
    n: float | None = None,
    runs: float = 32,
    queries: float = 1000,
    emission: _Emission | Iterable[_Emission] | None = None,
    seed: int = 0,
    pixels: Sequence[int] | None = None,
    reference: _Path | None = None,
    reference_photons: float | None = None,
    photons_only: bool | None = None,
    threads: int | None = None,
    progress: _Progress | None = None,
    directory: _Path | None = None,
) -> dict[str, NDArray[Any]]:
    """Random, stratified and Sobol photons against the truth ("analytic:NAME", or a scene): columns of a table."""

def blackbody_xyz(kelvin: ArrayLike) -> NDArray[np.float64]:
    """CIE 1931 XYZ of blackbodies [W/(m^2 sr)] by their temperatures [K]: (..., 3)."""

def read_vdb(
    path: _Path, grid: str | None = None, *, max_memory: float | None = None
) -> tuple[NDArray[np.float32], NDArray[np.float64], tuple[int, int, int]]:
    """The active box of a grid: (array, index_to_world, origin); ``array[i, j, k]`` is the voxel ``origin + (i, j, k)``."""

def write_vdb(
    path: _Path,
    array: ArrayLike,
    index_to_world: ArrayLike | None = None,
    origin: tuple[int, int, int] = (0, 0, 0),
    *,
    name: str = "density",
    background: float = 0.0,
    class_: Literal["fog volume", "level set", "staggered", "unknown"] | None = None,
    compression: Literal["blosc", "zip", "mask", "none"] = "blosc",
    half: bool = False,
) -> None:
    """Writes a dense array as a grid; voxels that differ from ``background`` are active."""
