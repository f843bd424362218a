"""What photonvdb cannot render is refused by name."""

import mitsuba as mi
import numpy as np
import photonvdb
import pytest
from grids import blob, gridvolume

from photonvdb_mitsuba import UnsupportedError


def transform():
    return mi.ScalarTransform4f()


def refusal(scene, **loading):
    """The sentence with which a scene is refused when it is rendered."""
    with pytest.raises(UnsupportedError) as refused:
        mi.render(mi.load_dict(scene, **loading))
    print(refused.value)
    return str(refused.value)


def medium(name, **more):
    return {"type": name, **more}


def texture():
    return {
        "type": "bitmap",
        "data": mi.TensorXf(np.linspace(0, 1, 48, dtype=np.float32).reshape(4, 4, 3)),
        "raw": True,
    }


SMOKE = {"type": "heterogeneous", "albedo": 0.9}

FILMED = {"film": {"type": "hdrfilm", "width": 4, "height": 4}}

#: Emitters of each kind that photonvdb does not have, with the words that name them.
EMITTERS = [
    (lambda: {"type": "projector", "to_world": transform()}, ["lamp", "Projector"]),
    (lambda: {"type": "sunsky"}, ["lamp", "Sunsky"]),
    (lambda: {"type": "spot", "texture": texture()}, ["lamp", "SpotLight", "texture", "BitmapTexture"]),
    (
        lambda: {"type": "point", "intensity": {"type": "blackbody", "temperature": 4000.0}},
        ["lamp", "BlackBodySpectrum"],
    ),
    (
        lambda: {"type": "spot", "to_world": transform().rotate([1, 1, 0], 30)},
        ["lamp", "SpotLight", "to_world", "axis of length 1"],
    ),
]


@pytest.mark.parametrize(("emitter", "words"), EMITTERS)
def test_emitters(fog, emitter, words):
    said = refusal({**fog, "lamp": emitter()})
    assert all(word in said for word in words)


def test_emitter_that_is_dark_to_mitsuba(fog):
    fog["dark"] = {**fog["lamp"], "sampling_weight": 0.0}
    said = refusal(fog)
    assert "dark" in said and "sampling_weight" in said


SENSORS = [
    ({"type": "thinlens", "aperture_radius": 0.1}, ["camera", "ThinLensCamera"]),
    ({"type": "orthographic"}, ["camera", "OrthographicCamera"]),
    ({"type": "perspective", "principal_point_offset_x": 0.1}, ["camera", "principal_point_offset_x"]),
]


@pytest.mark.parametrize(("sensor", "words"), SENSORS)
def test_sensors(fog, sensor, words):
    said = refusal({**fog, "camera": {**FILMED, **sensor}})
    assert all(word in said for word in words)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"far_clip": 6.0}, ["camera", "far_clip", "fog"]),
        ({"near_clip": 5.5}, ["camera", "near_clip", "fog"]),
        ({"medium": {"type": "homogeneous"}}, ["camera", "does not stand in it"]),
    ],
)
def test_views(fog, more, words):
    fog["camera"].update(more)
    said = refusal(fog)
    assert all(word in said for word in words)


def test_camera_in_a_medium_that_it_does_not_name(fog):
    fog["camera"]["to_world"] = transform().look_at([0, 0, 0.5], [0, 0, 0], [0, 1, 0])
    assert "does not name it" in refusal(fog)


def test_mirrored_camera(fog):
    fog["camera"]["to_world"] = fog["camera"]["to_world"] @ transform().scale([-1, 1, 1])
    assert "mirrors" in refusal(fog)


SHAPES = [
    (lambda fog: {"type": "cube"}, ["no medium"]),
    (lambda fog: {**fog, "type": "cylinder"}, ["Cylinder", "cubes and spheres"]),
    (lambda fog: {**fog, "bsdf": {"type": "diffuse"}}, ["SmoothDiffuse", "null"]),
    (lambda fog: {**fog, "to_world": transform().rotate([0, 1, 0], 30)}, ["turned", "axis-aligned"]),
    (lambda fog: {**fog, "to_world": transform().scale([1, 0, 1])}, ["flat"]),
    (lambda fog: {**fog, "exterior": {"type": "homogeneous"}}, ["medium outside"]),
    (lambda fog: {**fog, "flip_normals": True}, ["flipped normals"]),
    (lambda fog: {**fog, "emitter": {"type": "area"}}, ["shines"]),
]


@pytest.mark.parametrize(("shape", "words"), SHAPES)
def test_shapes(fog, shape, words):
    said = refusal({**fog, "fog": shape(fog["fog"])})
    assert 'shape "fog"' in said
    assert all(word in said for word in words)


def test_bodies_that_overlap(fog):
    fog["other"] = {**fog["fog"], "to_world": transform().translate([1.9, 0, 0])}
    said = refusal(fog, optimize=False)
    assert "overlap" in said and "fog" in said and "other" in said


def test_cubes_that_mitsuba_merged(fog):
    fog["other"] = {**fog["fog"], "to_world": transform().translate([3, 0, 0])}
    assert "optimize=False" in refusal(fog)


def test_scene_without_medium(fog):
    del fog["fog"]
    assert "no medium" in refusal(fog)


MEDIA = [
    (lambda: medium("homogeneous", phase={"type": "rayleigh"}), ["RayleighPhaseFunction", "isotropic and hg"]),
    (lambda: medium("homogeneous", albedo=gridvolume(blob())), ["albedo", "GridVolume"]),
    (lambda: medium("homogeneous", sigma_t=gridvolume(blob())), ["sigma_t", "GridVolume"]),
    (lambda: {**SMOKE, "sigma_t": 1.0}, ["sigma_t", "ConstVolume", "gridvolume"]),
    (lambda: {**SMOKE, "sigma_t": gridvolume(np.repeat(blob(), 3, axis=3))}, ["3 channels"]),
    (lambda: {**SMOKE, "sigma_t": gridvolume(blob(), filter_type="nearest")}, ["GridVolume", "filter_type"]),
    (lambda: {**SMOKE, "sigma_t": gridvolume(blob() + np.float32(1))}, ["GridVolume", "outermost voxels"]),
    (
        lambda: {**SMOKE, "sigma_t": gridvolume(blob(), transform().rotate([1, 1, 0], 30))},
        ["GridVolume", "axis of length 1"],
    ),
    (lambda: {**SMOKE, "sigma_t": gridvolume(blob(), transform().scale(1.5))}, ["cuts off", "fog"]),
]


@pytest.mark.parametrize(("interior", "words"), MEDIA)
def test_media(fog, interior, words):
    fog["fog"]["interior"] = interior()
    said = refusal(fog)
    assert 'medium "interior"' in said
    assert all(word in said for word in words)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"photon": 1000}, ['unknown property "photon"', 'did you mean "photons"']),
        ({"max_depth": 8}, ['unknown property "max_depth"']),
        ({"aovs": "single_scatter, depth"}, ['"depth"', "transmittance"]),
    ],
)
def test_properties(settings, words):
    with pytest.raises(Exception) as refused:
        mi.load_dict({"type": "photonvdb", **settings})
    assert all(word in str(refused.value) for word in words)


@pytest.mark.parametrize("settings", [{"divisor": "k+1"}, {"photons": 0}, {"max_radius": -1.0}])
def test_values_that_the_library_refuses(fog, settings):
    fog["integrator"].update(settings)
    with pytest.raises(photonvdb.Error, match=next(iter(settings))):
        mi.render(mi.load_dict(fog))


def test_spectral_variant():
    mi.set_variant("scalar_spectral")
    with pytest.raises(Exception, match="scalar_spectral is not supported"):
        mi.load_dict({"type": "photonvdb"})


def test_gradients(fog):
    scene = mi.load_dict(fog)
    for differentiate in (scene.integrator().render_forward, scene.integrator().render_backward):
        with pytest.raises(UnsupportedError, match="differentiable"):
            differentiate(scene, None)
