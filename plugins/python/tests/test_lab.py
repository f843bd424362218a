"""Tables: exact biases, measured ones, columns."""

import numpy as np
import pytest

import photonvdb


def test_random_photons_are_biased_by_1_over_k_minus_1():
    k = np.arange(2, 50)
    table = photonvdb.bias("3d-random", k=k, trials=0, divisors=["k", "k-1"])
    of_k, of_k_minus_1 = table["divisor"] == "k", table["divisor"] == "k-1"
    np.testing.assert_array_equal(table["k"][of_k], k)
    np.testing.assert_allclose(table["exact_mean"][of_k], k / (k - 1), rtol=1e-12)
    np.testing.assert_allclose(table["exact_bias"][of_k_minus_1], 0, atol=1e-12)
    assert np.isnan(table["measured_mean"]).all()
    # k = 2 has no variance.
    assert np.isinf(table["exact_variance"][0])


def test_measurements_agree_with_exact_values():
    table = photonvdb.bias(["1d-random", "3d-order"], k=[5, 20, 100], trials=20_000, seed=3)
    assert len(set(map(len, table.values()))) == 1
    assert table["k"].dtype == np.int64 and table["exact_bias"].dtype == np.float64
    assert set(table["model"]) == {"1d-random", "3d-order"}
    z = table["z"][~np.isnan(table["z"])]
    assert len(z) > 6 and np.abs(z).max() < 4.5


def test_equal_seeds_give_equal_tables():
    tables = [
        photonvdb.bias("3d-jittered", k=10, trials=500, seed=9, threads=threads) for threads in (1, 2)
    ]
    for name in tables[0]:
        np.testing.assert_array_equal(tables[0][name], tables[1][name])


def test_a_comparison_where_the_truth_is_known():
    heard = []
    table = photonvdb.compare(
        "analytic:point-absorbing", k=[10, 50], n=2e4, runs=8, queries=100, emission=["random", "stratified"],
        progress=lambda *told: heard.append(told),
    )
    assert list(table["emission"]) == ["random", "random", "stratified", "stratified"]
    assert (np.abs(table["law_z"][:2]) < 4.5).all()
    assert (table["variance_ratio"][2:] > 1).all()


def test_a_comparison_in_a_scene(fog):
    table = photonvdb.compare(
        fog, k=[5, 10], n=2000, runs=2, queries=20, emission="random", pixels=(4, 3), reference_photons=4000,
        photons_only=True,
    )
    assert list(table["target"]) == ["points", "points", "pixels"]
    assert np.isfinite(table["bias"]).all()


def test_tables_are_ready_for_pandas():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(photonvdb.bias("2d-random", k=range(2, 5), trials=0))
    assert len(frame) == 15


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda: photonvdb.bias("4d-random"), "3d-random"),
        (lambda: photonvdb.bias("3d-random", k=0), "k = 0"),
        (lambda: photonvdb.bias("3d-random", n=5, k=10), "n = 5"),
        (lambda: photonvdb.bias("3d-random", divisors="k-2"), "divisors"),
        (lambda: photonvdb.bias("3d-random", method="slow"), "method"),
        (lambda: photonvdb.compare("analytic:moon"), "beam"),
        (lambda: photonvdb.compare("analytic:beam", runs=1), "runs"),
        (lambda: photonvdb.compare("analytic:beam", n=1e9), "more runs"),
        (lambda: photonvdb.compare("analytic:beam", emission="laser"), "stratified"),
    ],
)
def test_what_is_wrong_is_said(ask, words):
    with pytest.raises(photonvdb.Error, match=words):
        ask()
