"""The engine within Blender: what it registers, its passes, its settings, its end, and what it says of what it cannot render."""

import math

import bpy
import numpy as np
import photonvdb
import pytest

PASSES = ("single_scatter", "multiple_scatter", "emission", "transmittance", "coverage")


@pytest.fixture
def fog(stage):
    stage.scene.render.resolution_x = stage.scene.render.resolution_y = 16
    stage.box()
    stage.light("POINT")
    return stage


def test_it_comes_and_goes(add_on):
    for _ in range(2):
        add_on.register()
        assert "PHOTONVDB" in [kind.bl_idname for kind in bpy.types.RenderEngine.__subclasses__() if hasattr(kind, "bl_idname")]
        assert bpy.context.scene.photonvdb.k == 50
        assert hasattr(bpy.types, "PHOTONVDB_PT_photons")
        add_on.unregister()
        assert not hasattr(bpy.context.scene, "photonvdb")
        assert not hasattr(bpy.types, "PHOTONVDB_PT_photons")


def test_passes_are_there_and_add_up(fog):
    layer = fog.scene.view_layers[0]
    layer.use_pass_z = True
    for name in PASSES:
        setattr(layer.photonvdb, f"use_{name}", True)
    fog.sky(0.2, 0.2, 0.2)
    picture = fog.in_photonvdb(10_000)
    parts = picture["Single Scatter"] + picture["Multiple Scatter"] + picture["Emission"]
    np.testing.assert_allclose(picture.color, parts, rtol=1e-5)
    np.testing.assert_allclose(picture["Combined"][..., 3], 1.0)
    np.testing.assert_allclose(picture["Coverage"][..., 0], 1.0 - picture["Transmittance"].mean(axis=2), atol=1e-5)
    assert 4.0 < picture["Depth"][8, 8, 0] < 8.0 and picture["Depth"][0, 0, 0] == 1e10
    assert picture["Single Scatter"][8, 8].min() > 0.0 and picture["Multiple Scatter"][8, 8].min() > 0.0


def test_passes_not_asked_for_are_not_there(fog):
    assert set(fog.in_photonvdb(1000).passes) == {"Combined"}


def test_rows_go_the_right_way_up(fog):
    fog.scene.objects["Box"].location.z = 1.2
    picture = fog.in_photonvdb(10_000)
    assert picture.color[:8].sum() > 4.0 * picture.color[8:].sum()


@pytest.mark.parametrize(
    "settings",
    [
        {"gather": "knn", "k": 20, "divisor": "calibrated"},
        {"gather": "lattice", "emission": "sobol", "passes": 2},
        {"limit": "ERROR", "target_error": 20.0, "photons": 0},
        {"limit": "TIME", "time_budget": 0.2, "photons": 0},
    ],
)
def test_settings_reach_the_library(fog, settings):
    assert fog.in_photonvdb(**{"photons": 5000, **settings}).mean.min() > 0.0


def test_a_seed_repeats_the_picture(fog):
    first, second, other = (fog.in_photonvdb(5000, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.color, second.color)
    assert not np.array_equal(first.color, other.color)


class Watched:
    """What of an engine hears of progress, with Esc pressed after a while: Blender's own methods cannot be replaced."""

    def __init__(self):
        self.told, self.texts = [], []

    def test_break(self):
        return len(self.told) > 3

    def update_progress(self, done):
        self.told.append(done)

    def update_stats(self, _, text):
        self.texts.append(text)


def test_a_break_ends_the_render_after_the_pass_in_flight(fog, add_on):
    settings = fog.scene.photonvdb
    # They would take hours.
    settings.passes = 1_000_000
    scene = {
        "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0], "resolution": [12, 8]},
        "medium": {"kind": "homogeneous", "bounds": {"center": [0, 0, 0], "radius": 1}, "sigma_t": 1.0, "albedo": 0.9},
        "light": [{"kind": "point", "position": [0, 3, 0], "intensity": 10.0}],
        "photons": {"count": 5000},
    }
    watched = Watched()
    image = photonvdb.render(scene, passes=settings.passes, progress=add_on.engine.Progress(watched, settings))
    assert 1 <= image.report["passes_done"] < 1000
    assert 3 < len(watched.told) < 1000 and all(0.0 <= done <= 1.0 for done in watched.told)
    assert any("of 1000000" in text for text in watched.texts)


def refused(stage, words):
    with pytest.raises(RuntimeError, match=words):
        stage.in_photonvdb(1000)


def test_a_surface_is_refused_by_name_or_left_out(fog):
    bpy.ops.mesh.primitive_uv_sphere_add()
    bpy.context.object.name = "Teapot"
    refused(fog, '"Teapot": it is a surface')
    assert fog.in_photonvdb(1000, unsupported="LEAVE_OUT").mean.min() > 0.0


def test_a_box_that_is_turned_is_refused(fog):
    fog.scene.objects["Box"].rotation_euler = (0.0, 0.0, 0.3)
    refused(fog, '"Box": a mesh of volume must be a box')


@pytest.mark.parametrize(
    ("kind", "properties", "words"),
    [
        ("AREA", {"spread": 1.0}, "spread"),
        ("SUN", {"angle": 0.5}, "parallel"),
        ("SPOT", {"use_square": True}, "square"),
        ("POINT", {"use_shadow": False}, "shadows"),
    ],
)
def test_lights_that_are_otherwise_are_refused(fog, kind, properties, words):
    fog.light(kind, **properties).name = "Lamp"
    refused(fog, f'"Lamp": .*{words}')


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda camera: setattr(camera, "type", "ORTHO"), "Ortho"),
        (lambda camera: setattr(camera, "type", "PANO"), "Pano"),
        (lambda camera: setattr(camera.dof, "use_dof", True), "depth of field"),
    ],
)
def test_cameras_that_are_no_pinhole_are_refused(fog, change, words):
    change(fog.camera.data)
    refused(fog, f'"Camera": .*{words}')


def test_what_else_is_missing_is_said(stage, smoke, tmp_path):
    refused(stage, "no volume")
    thing = stage.volume(tmp_path / "nothing.vdb")
    refused(stage, '"Smoke": ')
    thing.data.filepath = str(smoke)
    material = thing.data.materials[0]
    sockets = material.node_tree.nodes["Principled Volume"].inputs
    sockets["Density Attribute"].default_value = ""
    refused(stage, "density, temperature")
    sockets["Density Attribute"].default_value = "density"
    sockets["Emission Strength"].default_value = 1.0
    refused(stage, "glows alike everywhere")
    sockets["Emission Strength"].default_value = 0.0
    sockets["Color"].default_value, sockets["Absorption Color"].default_value = (0.5,) * 3 + (1.0,), (0.9, 0.1, 0.1, 1.0)
    refused(stage, "absorption is coloured")
    sockets["Absorption Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    noise = material.node_tree.nodes.new("ShaderNodeTexNoise")
    material.node_tree.links.new(noise.outputs[0], sockets["Density"])
    refused(stage, "Noise Texture")
    stage.scene.camera = None
    with pytest.raises(RuntimeError, match="camera"):
        stage.in_photonvdb(1000)


def test_without_light_there_is_an_alpha(stage, smoke):
    stage.volume(smoke)
    stage.scene.render.film_transparent = True
    picture = stage.in_photonvdb(1000)
    assert picture.mean.max() == 0.0 and picture["Combined"][..., 3].max() > 0.9


def test_light_from_below_comes_from_below(stage, smoke):
    """z is up: an axis that is turned wrongly would show."""
    stage.box(stage.material(Density=8.0, Color=(0.5, 0.5, 0.5, 1.0)))
    sun = stage.light("SUN", energy=3.0, angle=0.0)
    sun.rotation_euler = (math.pi, 0.0, 0.0)
    picture = stage.in_photonvdb(20_000).color.mean(axis=(1, 2))
    assert picture[24:].sum() > 2.0 * picture[:24].sum()
