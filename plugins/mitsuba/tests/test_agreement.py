"""The same scene by photonvdb and by Mitsuba's volpath, in one process.

Means of the image are compared by z-scores of 32 independent batches each, and blocks of 8 x 8 pixels by the root mean square
of their differences: up to twice the noise, as few bright blocks make most of it, and half a percent of the image.
"""

import mitsuba as mi
import numpy as np
import pytest
from grids import blob, gridvolume, sky

import photonvdb_mitsuba  # noqa: F401

SIDE = 32
BLOCK = 8
BATCHES = 32


def transform():
    return mi.ScalarTransform4f()


def camera(origin):
    return {
        "type": "perspective",
        "fov": 30,
        "to_world": transform().look_at(origin, [0, 0, 0], [0, 1, 0]),
        "film": {"type": "hdrfilm", "width": SIDE, "height": SIDE, "rfilter": {"type": "box"}},
    }


def body(shape, interior, **more):
    return {"type": shape, "bsdf": {"type": "null"}, "interior": interior, **more}


def color(*value):
    return {"type": "rgb", "value": list(value)}


def fog_and_lamp():
    """A box of fog, of another extinction and albedo in each channel, with a point light beside it."""
    fog = {"type": "homogeneous", "sigma_t": color(0.5, 0.8, 1.0), "scale": 2.0, "albedo": color(0.95, 0.9, 0.8)}
    return {
        "camera": camera([0.5, 1, 6]),
        "fog": body("cube", fog, to_world=transform().scale([1, 0.8, 1.2])),
        "lamp": {"type": "point", "position": [1, 2, 1.5], "intensity": color(10, 20, 30)},
    }


def ball_and_spot():
    """A ball that scatters forward, with a spot that falls off to its edge."""
    fog = {"type": "homogeneous", "sigma_t": 1.5, "albedo": 0.9, "phase": {"type": "hg", "g": 0.6}}
    return {
        "camera": camera([2, 1, 5]),
        "ball": body("sphere", fog, radius=1.2),
        "lamp": {
            "type": "spot",
            "to_world": transform().look_at([0, 3, 0.2], [0, 0, 0], [0, 0, 1]),
            "intensity": color(30, 20, 10),
            "cutoff_angle": 24.0,
            "beam_width": 12.0,
        },
    }


def fog_and_sun():
    """A box that scatters backward, in sunlight."""
    fog = {"type": "homogeneous", "sigma_t": 1.5, "albedo": 0.9, "phase": {"type": "hg", "g": -0.4}}
    return {
        "camera": camera([2, 1, 5]),
        "fog": body("cube", fog),
        "sun": {"type": "directional", "direction": [1, -1, -0.4], "irradiance": color(3, 2, 1)},
    }


def smoke(to_world, light):
    """Smoke in a grid, turned and stretched, in light from all around, which the camera does not see."""
    smoke = {
        "type": "heterogeneous",
        "sigma_t": gridvolume(blob(), to_world),
        "scale": 6.0,
        "albedo": color(0.9, 0.7, 0.5),
        "phase": {"type": "hg", "g": 0.3},
    }
    return {"camera": camera([2, 1, 5]), "smoke": body("cube", smoke, to_world=to_world), "light": light}


def smoke_and_sky():
    """Smoke in a sky of an image, both turned."""
    turned = transform().translate([0.1, 0.2, -0.1]).rotate([0.48, 0.8, 0.36], 35).scale([1.2, 0.9, 1.1])
    around = {"type": "envmap", "bitmap": sky(), "scale": 1.5, "to_world": transform().rotate([0.8, 0.48, 0.36], 40)}
    return smoke(turned, around)


def smoke_in_white():
    """Smoke in constant light."""
    return smoke(transform(), {"type": "constant", "radiance": color(0.5, 0.7, 1.0)})


def batches(scene, integrator, spp):
    """Independent images: (batch, row, column, channel)."""
    integrator = mi.load_dict({"hide_emitters": True, **integrator})
    seeds = range(BATCHES)
    return np.array([mi.render(scene, integrator=integrator, spp=spp, seed=1 + seed) for seed in seeds], dtype=float)


def block_means(images):
    shape = (len(images), SIDE // BLOCK, BLOCK, SIDE // BLOCK, BLOCK, 3)
    return images.reshape(shape).mean(axis=(2, 4))


def mean_and_error(batch_values):
    return batch_values.mean(axis=0), batch_values.std(axis=0, ddof=1) / np.sqrt(BATCHES)


@pytest.mark.parametrize(
    ("made", "settings", "spp"),
    [
        (fog_and_lamp, {}, 96),
        # The edge of the cone is finer than the cells of the lattice that so few photons have by default.
        (ball_and_spot, {"lattice": 64}, 64),
        (fog_and_sun, {}, 48),
        (smoke_and_sky, {}, 48),
        (smoke_in_white, {}, 32),
    ],
)
def test_images_agree_with_volpath(made, settings, spp):
    scene = mi.load_dict({"type": "scene", **made()})
    theirs = batches(scene, {"type": "volpath", "max_depth": -1, "rr_depth": 1000}, spp)
    ours = batches(scene, {"type": "photonvdb", "photons": 50_000, **settings}, 8)

    (their_mean, their_error), (our_mean, our_error) = (mean_and_error(one.mean(axis=(1, 2))) for one in (theirs, ours))
    error = np.hypot(their_error, our_error)
    z = (our_mean - their_mean) / error
    print(f"{made.__name__}: means {their_mean} {our_mean}, errors {error / their_mean}, z {z}")
    assert np.all(error < 0.01 * their_mean)
    assert np.all(np.abs(z) < 4.5)

    (their_blocks, their_error), (our_blocks, our_error) = (mean_and_error(block_means(one)) for one in (theirs, ours))
    difference = np.sqrt(np.mean((our_blocks - their_blocks) ** 2)) / their_mean.mean()
    noise = np.sqrt(np.mean(their_error**2 + our_error**2)) / their_mean.mean()
    print(f"  blocks differ by {difference:.4f}, with a noise of {noise:.4f}")
    assert noise < 0.015
    assert difference < np.hypot(2 * noise, 0.005)


def test_nearest_photons_agree_with_volpath():
    """The estimate of k nearest photons, whose balls blur: 3 % of the mean."""
    scene = mi.load_dict({"type": "scene", **fog_and_lamp()})
    settings = {"photons": 200_000, "k": 50, "divisor": "k-1", "emission": "random"}
    theirs, ours = (
        np.mean(mi.render(scene, integrator=mi.load_dict({"type": name, **more}), spp=spp, seed=1))
        for name, spp, more in (("volpath", 1024, {"max_depth": -1}), ("photonvdb", 8, settings))
    )
    assert abs(ours / theirs - 1) < 0.03
