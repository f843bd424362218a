"""What all tests share. Where Mitsuba or photonvdb is missing, nothing is run and the reason is said."""

import pytest

for module in ("mitsuba", "numpy", "photonvdb", "photonvdb_mitsuba"):
    pytest.importorskip(module, reason=f"{module} is not installed")

import mitsuba as mi

mi.set_variant("scalar_rgb")


@pytest.fixture(autouse=True)
def variant():
    """Every test begins in the variant that needs nothing but Mitsuba itself."""
    mi.set_variant("scalar_rgb")


@pytest.fixture
def fog():
    """A small scene as a dict: a point light beside a cube of fog."""
    return {
        "type": "scene",
        "integrator": {"type": "photonvdb", "photons": 2000},
        "camera": {
            "type": "perspective",
            "fov": 30,
            "to_world": mi.ScalarTransform4f().look_at([0, 1, 6], [0, 0, 0], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": 12, "height": 8, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent", "sample_count": 2},
        },
        "fog": {
            "type": "cube",
            "bsdf": {"type": "null"},
            "interior": {
                "type": "homogeneous",
                "sigma_t": {"type": "rgb", "value": [0.5, 0.6, 0.7]},
                "scale": 2.0,
                "albedo": 0.9,
                "phase": {"type": "hg", "g": 0.3},
            },
        },
        "lamp": {"type": "point", "position": [0, 3, 1], "intensity": {"type": "rgb", "value": [10, 20, 30]}},
    }
