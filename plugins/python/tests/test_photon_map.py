"""Photon maps: exact fluence, shapes, repeatability."""

import math

import numpy as np
import pytest

import photonvdb


@pytest.fixture
def map_(furnace):
    return photonvdb.PhotonMap.build(furnace, photons_only=True, k=100)


def test_fluence_in_a_furnace_is_4_pi(map_):
    points = np.random.default_rng(1).uniform(-0.9, 0.9, (2000, 3))
    # Photons of 2000 places in 5.8 m^3 are shared: some 1000 independent balls, 10 % each.
    assert abs(map_.fluence(points).mean() / (4 * math.pi) - 1) < 0.02
    # sigma_t is 1 / m.
    inner = 0.5 * points
    assert abs(map_.power_density(inner).mean() / (4 * math.pi) - 1) < 0.02


def test_divisors_are_in_their_proportion(map_):
    place = [0.1, 0.2, -0.3]
    whole = map_.power_density(place, 100, "k")
    np.testing.assert_allclose(map_.power_density(place, 100, "k-1") / whole, 99 / 100, rtol=1e-3)
    np.testing.assert_allclose(map_.power_density(place, 100, "k-1/2") / whole, 99.5 / 100, rtol=1e-3)
    np.testing.assert_array_equal(map_.power_density(place), map_.power_density(place, 100, "k-1"))


def test_the_calibrated_divisor_takes_a_measurement(map_, furnace):
    with pytest.raises(photonvdb.Error, match="calibrated"):
        map_.fluence([0, 0, 0], divisor="calibrated")
    calibrated = photonvdb.PhotonMap.build(furnace, photons=2e4, divisor="calibrated")
    assert calibrated.fluence([0, 0, 0], k=30).min() > 0
    assert calibrated.report["calibration"]["constant"] > 0


def test_shapes_follow_the_points(map_):
    assert len(map_) == map_.report["photons"]["stored"] > 0
    assert map_.fluence([0, 0, 0]).shape == (3,)
    assert map_.fluence(np.zeros((2, 5, 3), np.float32)).shape == (2, 5, 3)
    assert map_.fluence(np.zeros((0, 3))).shape == (0, 3)


def test_rays_see_light_and_transmittance(map_):
    directions = [[0, 0, -2.0], [0, 0, 1]]
    radiance, transmittance = map_.radiance([0, 0, 5], directions)
    np.testing.assert_allclose(transmittance[:, 0], [math.exp(-2), 1], rtol=1e-9)
    np.testing.assert_allclose(radiance[1], 1, rtol=1e-9)
    assert abs(radiance[0, 0] - 1) < 0.2
    _, near = map_.radiance([0, 0, 5], directions, t_max=5)
    np.testing.assert_allclose(near[0], math.exp(-1), rtol=1e-9)
    _, each = map_.radiance([0, 0, 5], directions, t_max=[4.5, 1])
    np.testing.assert_allclose(each[:, 0], [math.exp(-0.5), 1], rtol=1e-9)
    again, _ = map_.radiance([0, 0, 5], directions)
    np.testing.assert_array_equal(again, radiance)


def test_maps_are_the_same_for_any_number_of_threads(fog):
    points = np.random.default_rng(2).uniform(-1, 1, (50, 3))
    maps = [photonvdb.PhotonMap.build(fog, threads=threads) for threads in (1, 3)]
    np.testing.assert_array_equal(maps[0].fluence(points), maps[1].fluence(points))


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda m: m.fluence([0, 0]), "points"),
        (lambda m: m.fluence([0, 0, math.nan]), "not finite"),
        (lambda m: m.fluence([0, 0, 0], k=0), "k:"),
        (lambda m: m.fluence([0, 0, 0], k=10**9), "k:"),
        (lambda m: m.fluence([0, 0, 0], divisor="k+1"), "divisor"),
        (lambda m: m.radiance([0, 0, 0], [0, 0, 0]), "no length"),
        (lambda m: m.radiance([[0, 0, 0]] * 2, [[0, 0, 1]] * 3), "shape"),
        (lambda m: m.radiance([0, 0, 0], [0, 0, 1], t_max=-1), "t_max"),
        (lambda m: m.radiance([0, 0, 0], [0, 0, 1], t_max=[1, 2]), "t_max"),
    ],
)
def test_what_is_wrong_is_said(fog, ask, words):
    with pytest.raises(photonvdb.Error, match=words):
        ask(photonvdb.PhotonMap.build(fog, photons=1000))
