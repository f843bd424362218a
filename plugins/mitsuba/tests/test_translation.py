"""What a Mitsuba scene becomes."""

import mitsuba as mi
import numpy as np
import photonvdb
import pytest
from grids import blob, gridvolume, sky

from photonvdb_mitsuba import scene_file
from photonvdb_mitsuba.environment import radiance


def transform():
    return mi.ScalarTransform4f()


def translated(scene, directory):
    loaded = mi.load_dict(scene)
    return scene_file(loaded, loaded.sensors()[0], directory)


def test_fog(fog, tmp_path):
    tables = translated(fog, tmp_path)
    (medium,), (light,) = tables["medium"], tables["light"]
    assert medium["kind"] == "homogeneous"
    assert medium["bounds"]["min"] == pytest.approx([-1, -1, -1])
    assert medium["bounds"]["max"] == pytest.approx([1, 1, 1])
    assert medium["sigma_t"] == pytest.approx([1.0, 1.2, 1.4])
    assert medium["albedo"] == pytest.approx([0.9, 0.9, 0.9])
    assert medium["phase"] == {"kind": "henyey-greenstein", "g": pytest.approx(0.3)}
    assert light == {"kind": "point", "position": [0, 3, 1], "intensity": [10, 20, 30]}


@pytest.mark.parametrize(
    ("axis", "vertical"), [("x", 2 * np.degrees(np.arctan(np.tan(np.radians(20)) * 8 / 12))), ("y", 40)]
)
def test_field_of_view(fog, tmp_path, axis, vertical):
    fog["camera"].update(fov=40, fov_axis=axis)
    camera = translated(fog, tmp_path)["camera"]
    assert camera["vertical_fov"] == pytest.approx(vertical, rel=1e-5)
    assert camera["resolution"] == [12, 8]
    forward = np.subtract(camera["look_at"], camera["position"])
    assert forward == pytest.approx(np.array([0, -1, -6]) / np.sqrt(37), abs=1e-6)


def test_sphere_and_turned_cube(fog, tmp_path):
    fog["fog"]["to_world"] = transform().translate([0, 4, 0]).rotate([0, 0, 1], 90).scale([1, 2, 3])
    ball = {"type": "sphere", "center": [1, 0, 0], "radius": 0.5, "to_world": transform().scale(2)}
    fog["ball"] = {**fog["fog"], **ball}
    media = [medium["bounds"] for medium in translated(fog, tmp_path)["medium"]]
    ball, box = sorted(media, key=lambda bounds: "min" in bounds)
    assert ball["center"] == pytest.approx([2, 0, 0])
    assert ball["radius"] == pytest.approx(1)
    assert box["min"] == pytest.approx([-2, 3, -3], abs=1e-5)
    assert box["max"] == pytest.approx([2, 5, 3], abs=1e-5)


def test_spot_and_sun(fog, tmp_path):
    place = transform().look_at([1, 2, 3], [1, 0, 3], [0, 0, 1])
    fog["lamp"] = {"type": "spot", "to_world": place, "intensity": 2.0, "cutoff_angle": 30.0}
    fog["sun"] = {"type": "directional", "direction": [0, -2, 0], "irradiance": 3.0}
    spot, sun = sorted(translated(fog, tmp_path)["light"], key=lambda light: light["kind"], reverse=True)
    assert spot["look_at"] == pytest.approx([1, 1, 3])
    assert (spot["cone_angle"], spot["falloff_angle"]) == pytest.approx((30, 22.5))
    assert spot["intensity"] == [2, 2, 2]
    assert sun == {"kind": "directional", "direction": pytest.approx([0, -1, 0]), "irradiance": [3, 3, 3]}


def test_grid_lies_where_mitsuba_has_it(fog, tmp_path):
    """Every voxel's middle, and its value there."""
    array = blob(5, 6, 7)
    turned = transform().translate([10, 20, 30]).rotate([0.48, 0.8, 0.36], 35).scale([1, -2, 3])
    smoke = {"type": "heterogeneous", "sigma_t": gridvolume(array, turned), "scale": 4.0, "albedo": 0.5}
    fog["fog"].update(to_world=turned, interior=smoke)
    (medium,) = translated(fog, tmp_path)["medium"]
    assert (medium["kind"], medium["density_scale"]) == ("vdb", pytest.approx(4))
    values, index_to_world, origin = photonvdb.read_vdb(tmp_path / medium["file"])
    volume = mi.load_dict(smoke["sigma_t"])
    place = mi.Interaction3f()
    for index in np.ndindex(values.shape):
        place.p = (index_to_world @ [*np.add(index, origin), 1])[:3].tolist()
        assert volume.eval_1(place) == pytest.approx(values[index], abs=1e-4)


def test_environment_is_read_as_mitsuba_reads_it():
    emitter = mi.load_dict({"type": "envmap", "bitmap": sky()})
    directions = np.random.default_rng(1).normal(size=(2000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    read = radiance(np.array(mi.traverse(emitter)["data"]), directions)
    seen = mi.SurfaceInteraction3f()
    for direction, value in zip(directions, read):
        seen.wi = (-direction).tolist()
        assert np.array(emitter.eval(seen)) == pytest.approx(value, abs=1e-4)


def test_environment_is_turned(fog, tmp_path):
    """The finer image has Mitsuba's values at its pixels' middles, and its rows and columns are where photonvdb has them."""
    place = transform().rotate([0.8, 0.48, 0.36], 40)
    fog["lamp"] = {"type": "envmap", "bitmap": sky(), "scale": 2.0, "to_world": place}
    scene = mi.load_dict(fog)
    (light,) = translated(fog, tmp_path)["light"]
    assert light["scale"] == 2
    image = np.array(mi.Bitmap(str(tmp_path / light["file"])))
    height, width = image.shape[:2]
    seen = mi.SurfaceInteraction3f()
    for row, column in np.random.default_rng(2).integers(0, [height, width], (500, 2)):
        polar, azimuth = np.pi * (row + 0.5) / height, 2 * np.pi * ((column + 0.5) / width - 0.5)
        to = np.array([np.sin(polar) * np.sin(azimuth), np.cos(polar), -np.sin(polar) * np.cos(azimuth)])
        seen.wi = (-to).tolist()
        assert np.array(scene.environment().eval(seen)) == pytest.approx(2 * image[row, column], abs=1e-3)
