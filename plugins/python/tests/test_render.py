"""Renders: shapes, exact answers, the command line's bytes, limits, interruptions."""

import _thread
import json
import math
import subprocess
import threading
import time

import numpy as np
import pytest

import photonvdb


def test_layers_are_float32_arrays_that_add_up(fog):
    image = photonvdb.render(fog)
    assert list(image) == ["rgba", "emission", "multiple_scatter", "single_scatter", "transmittance"]
    assert len(image) == 5 and "rgba" in image and "Z" not in image
    for name, layer in image.layers.items():
        assert layer.dtype == np.float32 and layer.flags.c_contiguous
        assert layer.shape == ((8, 12, 4) if name == "rgba" else (8, 12, 3))
    parts = image["single_scatter"] + image["multiple_scatter"] + image["emission"]
    np.testing.assert_allclose(image["rgba"][..., :3], parts, rtol=1e-6)
    np.testing.assert_allclose(image["rgba"][..., 3], 1 - image["transmittance"].mean(axis=2), atol=1e-6)
    assert image["rgba"][4, 6].min() > 0
    with pytest.raises(KeyError, match="rgba"):
        image["depth"]


def test_transmittance_through_fog_is_exponential(fog):
    fog["camera"].update(vertical_fov=1e-3, resolution=[1, 1])
    for sigma_t in [0.25, 1.0, 3.0]:
        fog["medium"]["sigma_t"] = sigma_t
        transmittance = photonvdb.render(fog, photons=100)["transmittance"]
        np.testing.assert_allclose(transmittance, math.exp(-2 * sigma_t), rtol=1e-6)


def test_a_white_furnace_looks_like_nothing(furnace):
    renders = [photonvdb.render(furnace, photons=5000, gather="knn", seed=seed) for seed in range(32)]
    means = np.array([image["rgba"][..., :3].mean() for image in renders])
    z = (means.mean() - 1) / (means.std(ddof=1) / np.sqrt(len(means)))
    assert abs(z) < 4.5 and abs(means.mean() - 1) < 0.02


def test_arrays_and_files_are_those_of_the_command_line(root, cli, tmp_path):
    scene = root / "tests/scenes/fog_spot.toml"
    theirs, ours = tmp_path / "theirs.exr", tmp_path / "ours.exr"
    arguments = ["--photons", "20000", "--resolution", "32x24", "--seed", "7"]
    subprocess.run([cli, "render", scene, "-o", theirs, *arguments, "--quiet"], check=True)
    image = photonvdb.render(scene, photons=20000, resolution=(32, 24), seed=7, threads=1)
    image.write_exr(ours)
    assert ours.read_bytes() == theirs.read_bytes()
    # The file holds what the arrays hold.
    again = photonvdb.render(scene, photons=20000, resolution=(32, 24), seed=7, threads=2)
    for name in image:
        assert again[name].tobytes() == image[name].tobytes(), name


def test_a_dict_is_the_same_scene_as_its_file(fog, tmp_path):
    path = tmp_path / "fog.json"
    path.write_text(json.dumps(fog))
    fog["light"][0]["position"] = np.array([0, 3, 0])
    fog["photons"]["count"] = np.int64(5000)
    ours, theirs = photonvdb.render(fog), photonvdb.render(str(path))
    assert ours["rgba"].tobytes() == theirs["rgba"].tobytes()
    assert ours.report["settings"]["scene_hash"] == theirs.report["settings"]["scene_hash"]


def test_files_of_a_dict_are_relative_to_its_directory(fog, root):
    fog["medium"] = {"kind": "vdb", "file": "smoke.vdb", "density_scale": 10.0, "albedo": 0.9}
    image = photonvdb.render(fog, directory=root / "tests/scenes", photons=1000)
    assert image.report["plan"]["medium"] == "grid"
    with pytest.raises(photonvdb.Error, match="smoke.vdb"):
        photonvdb.render(fog, directory=root / "tests")


def test_the_report_says_what_was_done(fog):
    report = photonvdb.render(fog, photons=1e4, passes=3, seed=5, k=20, divisor="k-1/2", gather="knn").report
    assert report["passes_done"] == 3
    assert report["photons"]["emitted"] == 30000
    assert report["settings"]["photons"]["seed"] == 5
    assert report["settings"]["estimate"] == {"k": 20, "divisor": "k-1/2", "kernel": "constant"}
    power = report["power"]
    gone = np.sum([power[way] for way in ["absorbed", "escaped", "truncated", "resampled"]], axis=0)
    np.testing.assert_allclose(gone, power["emitted"], rtol=1e-9)
    assert report["seconds"]["total"] > 0


def test_layers_asked_for_are_there(fog):
    image = photonvdb.render(fog, layers=["depth", "alpha", "lights", "photon_count"])
    assert image["Z"].shape == (8, 12) and image["alpha"].shape == (8, 12, 3)
    lights = [name for name in image if name.startswith("light.")]
    total = sum(image[name] for name in lights)
    np.testing.assert_allclose(total, image["rgba"][..., :3], rtol=1e-5)


def test_a_target_error_is_worked_towards(fog):
    report = photonvdb.render(fog, target_error=0.05).report
    assert report["estimated_relative_error"] <= 0.05
    assert report["passes_done"] > 1


def test_progress_hears_of_every_pass_and_may_end_the_render(fog):
    heard = []
    photonvdb.render(fog, passes=4, progress=lambda *told: heard.append(told))
    passes = [told for told in heard if told[0] == "pass"]
    assert [told[2] for told in passes] == [1, 2, 3, 4]
    assert all(0 <= told[1] <= 1 for told in heard)

    ended = photonvdb.render(fog, passes=100_000, progress=lambda stage, *_: stage != "pass")
    assert 1 <= ended.report["passes_done"] < 1000


def test_an_exception_in_progress_ends_the_render(fog):
    def fail(*_):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        photonvdb.render(fog, passes=100_000, progress=fail)


def test_an_interrupt_ends_the_render(fog):
    timer = threading.Timer(0.3, _thread.interrupt_main)
    timer.start()
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        photonvdb.render(fog, passes=1_000_000)
    assert time.monotonic() - started < 30


def test_other_threads_run_meanwhile(fog):
    count = 0
    done = threading.Event()

    def work():
        nonlocal count
        while not done.is_set():
            count += 1
            time.sleep(0.001)

    thread = threading.Thread(target=work)
    thread.start()
    photonvdb.render(fog, time_budget=0.5)
    done.set()
    thread.join()
    assert count > 20


@pytest.mark.parametrize(
    ("change", "arguments", "words"),
    [
        ({}, {"k": 0}, "estimate.k"),
        ({}, {"photons": -1}, "whole number"),
        ({}, {"photons": 1.5}, "whole number"),
        ({}, {"passes": 0}, "passes"),
        ({}, {"target_error": -1.0}, "target_error"),
        ({}, {"threads": 0}, "threads"),
        ({}, {"divisor": "k-2"}, "estimate.divisor"),
        ({}, {"gather": "lattise"}, "render.gather"),
        ({}, {"layers": ["deep"]}, "layers"),
        ({"camra": {}}, {}, "camra"),
        ({"light": []}, {}, "no light"),
        ({"medium": {"kind": "homogeneous", "bounds": "infinite", "sigma_t": 1.0, "albedo": 0.5}}, {}, "medium.bounds"),
        ({"photons": {"count": {1}}}, {}, "no set"),
    ],
)
def test_what_is_wrong_is_said(fog, change, arguments, words):
    fog.update(change)
    with pytest.raises(photonvdb.Error, match=words) as raised:
        photonvdb.render(fog, **arguments)
    assert isinstance(raised.value, ValueError)


def test_files_that_are_not_there_are_os_errors(fog, tmp_path):
    with pytest.raises(FileNotFoundError, match="nothing.toml"):
        photonvdb.render(tmp_path / "nothing.toml")
    with pytest.raises(FileNotFoundError):
        photonvdb.render(fog).write_exr(tmp_path / "no" / "image.exr")
    with pytest.raises(TypeError):
        photonvdb.render(5)
