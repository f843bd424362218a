"""Films, seeds, settings and variants."""

import os
import subprocess
import sys

import mitsuba as mi
import numpy as np
import photonvdb
import pytest

from photonvdb_mitsuba import scene_file


def image(scene, **arguments):
    return np.array(mi.render(mi.load_dict(scene), **arguments))


def test_image_is_the_librarys(fog, tmp_path):
    """Of the same photons, with the seed and the rays a pixel that Mitsuba was asked for."""
    scene = mi.load_dict(fog)
    tables = scene_file(scene, scene.sensors()[0], tmp_path)
    tables["render"] = {"samples_per_pixel": 3}
    expected = photonvdb.render(tables, seed=7, photons=2000)["rgba"][..., :3]
    assert np.array_equal(image(fog, seed=7, spp=3), expected)
    assert not np.array_equal(image(fog, seed=8, spp=3), expected)


def test_sampler_says_how_many_rays_a_pixel_has(fog):
    assert np.array_equal(image(fog), image(fog, spp=2))
    assert not np.array_equal(image(fog), image(fog, spp=4))


def test_crop_is_cut_from_the_image(fog):
    whole = image(fog)
    fog["camera"]["film"].update(crop_offset_x=3, crop_offset_y=1, crop_width=6, crop_height=5)
    assert np.array_equal(image(fog), whole[1:6, 3:9])


@pytest.mark.parametrize(("pixels", "channels"), [("rgb", 3), ("rgba", 4), ("luminance", 1), ("luminance_alpha", 2)])
def test_pixel_formats(fog, pixels, channels):
    whole = image(fog)
    fog["camera"]["film"].update(pixel_format=pixels, rfilter={"type": "gaussian"}, sample_border=True)
    formatted = image(fog)
    assert formatted.shape == (8, 12, channels)
    if pixels.startswith("rgb"):
        assert np.array_equal(formatted[..., :3], whole)
    else:
        assert formatted[..., 0] == pytest.approx(whole @ [0.212671, 0.715160, 0.072169], rel=1e-4)
    if channels % 2 == 0:
        assert 0.3 < formatted[..., -1].max() < 1


def test_layers(fog):
    fog["integrator"]["aovs"] = "single_scatter, multiple_scatter,transmittance"
    scene = mi.load_dict(fog)
    assert scene.integrator().aov_names()[:4] == [
        "single_scatter.R",
        "single_scatter.G",
        "single_scatter.B",
        "multiple_scatter.R",
    ]
    seen = np.array(mi.render(scene))
    assert seen.shape == (8, 12, 12)
    assert seen[..., 3:6] + seen[..., 6:9] == pytest.approx(seen[..., :3], rel=1e-5)
    # The corner sees past the box.
    assert seen[0, 0, 9:] == pytest.approx(1)


def test_film_can_be_written(fog, tmp_path):
    scene = mi.load_dict(fog)
    rendered = np.array(mi.render(scene))
    scene.sensors()[0].film().write(str(tmp_path / "fog.exr"))
    assert np.array(mi.Bitmap(str(tmp_path / "fog.exr"))) == pytest.approx(rendered, rel=2e-3)


def test_undeveloped(fog):
    scene = mi.load_dict(fog)
    assert np.array(scene.integrator().render(scene, develop=False)).size == 0
    assert np.array_equal(np.array(scene.sensors()[0].film().develop()), image(fog))


def test_hidden_emitters(fog):
    fog["sky"] = {"type": "constant", "radiance": 2.0}
    assert image(fog)[0, 0] == pytest.approx(2)
    fog["integrator"]["hide_emitters"] = True
    assert image(fog)[0, 0] == pytest.approx(0)
    assert image(fog)[4, 6].min() > 0.1


def test_settings_reach_the_library(fog):
    fog["integrator"].update(k=20, divisor="k", kernel="constant", emission="random", passes=2, threads=1)
    high = image(fog)
    fog["integrator"]["divisor"] = "k-1"
    assert image(fog).mean() < high.mean()


def test_camera_within_the_medium(fog):
    fog["mist"] = fog["fog"].pop("interior")
    fog["fog"]["interior"] = {"type": "ref", "id": "mist"}
    fog["camera"]["medium"] = {"type": "ref", "id": "mist"}
    fog["camera"]["to_world"] = mi.ScalarTransform4f().look_at([0, 0, 0.5], [0, 0, 0], [0, 1, 0])
    ordered = {name: fog[name] for name in ("type", "integrator", "mist", "camera", "fog", "lamp")}
    assert image(ordered).min() > 0


LLVM = """
import mitsuba as mi
mi.set_variant("llvm_ad_rgb")
import numpy as np
import photonvdb_mitsuba
import test_agreement
print(np.array(mi.render(
    mi.load_dict({"type": "scene", **test_agreement.smoke_and_sky()}),
    integrator=mi.load_dict({"type": "photonvdb", "photons": 2000, "aovs": "single_scatter"}), spp=2, seed=3,
)).astype(float).mean(axis=(0, 1)).tolist())
"""


def test_llvm_variant_makes_the_same_image():
    """In a process of its own: an LLVM that is too old for Mitsuba ends it."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    ran = subprocess.run([sys.executable, "-c", LLVM], capture_output=True, text=True, check=False, env=environment)
    if "LLVM" in ran.stderr and "photonvdb_mitsuba" not in ran.stderr:
        pytest.skip(f"no LLVM that Mitsuba can use: {ran.stderr.strip().splitlines()[0]}")
    assert ran.returncode == 0, ran.stderr
    from test_agreement import smoke_and_sky

    integrator = mi.load_dict({"type": "photonvdb", "photons": 2000, "aovs": "single_scatter"})
    scalar = mi.render(mi.load_dict({"type": "scene", **smoke_and_sky()}), integrator=integrator, spp=2, seed=3)
    means = [float(number) for number in ran.stdout.strip().strip("[]").split(",")]
    assert np.array(scalar).astype(float).mean(axis=(0, 1)) == pytest.approx(means, rel=1e-3)
