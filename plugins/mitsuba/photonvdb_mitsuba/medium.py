"""Media: homogeneous ones in a cube or sphere, and grids of extinction."""

from .color import constant_volume
from .errors import UnsupportedError
from .grid import write_grid
from .parts import children, described, number, values
from .phase import phase_table


def medium_table(body, directory, number_of: int) -> dict:
    """One ``[[medium]]``; a grid is written into ``directory`` as an OpenVDB file."""
    medium = body.medium
    name = described("medium", medium)
    parts = children(medium)
    scale = number(values(medium)["scale"]) if "scale" in values(medium) else 1.0
    kind = medium.class_name()
    if kind == "HomogeneousMedium":
        sigma_t = constant_volume(parts["sigma_t"], f"{name}: sigma_t")
        table = {
            "kind": "homogeneous",
            "bounds": body.bounds_table(),
            "sigma_t": [scale * value for value in sigma_t],
        }
    elif kind == "HeterogeneousMedium":
        file = f"medium{number_of}.vdb"
        write_grid(parts["sigma_t"], body, directory / file, f"{name}: sigma_t")
        table = {"kind": "vdb", "file": file, "density_scale": scale}
    else:
        raise UnsupportedError(f"{name} is not supported; media are homogeneous or heterogeneous")
    albedo = constant_volume(parts["albedo"], f"{name}: albedo")
    return {**table, "albedo": albedo, "phase": phase_table(medium.phase_function(), name)}
