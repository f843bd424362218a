"""Volumes: round trips to the bit, known files, refusals."""

import json

import numpy as np
import pytest

import photonvdb

TO_WORLD = np.array([[0.1, 0, 0, 1], [0, 0.2, 0, 2], [0, 0, 0.3, 3], [0, 0, 0, 1.0]])


@pytest.mark.parametrize("compression", ["blosc", "zip", "mask", "none"])
@pytest.mark.parametrize("origin", [(0, 0, 0), (-13, 5, 100_000)])
def test_arrays_come_back_to_the_bit(tmp_path, compression, origin):
    path = tmp_path / "noise.vdb"
    array = np.random.default_rng(0).uniform(0.1, 1, (17, 9, 30)).astype(np.float32)
    array[3:6, 2, 4:9] = 0
    photonvdb.write_vdb(path, array, TO_WORLD, origin, compression=compression)
    back, index_to_world, lowest = photonvdb.read_vdb(path)
    assert back.tobytes() == array.tobytes() and back.shape == array.shape
    assert back.dtype == np.float32
    np.testing.assert_allclose(index_to_world, TO_WORLD, rtol=1e-15)
    assert lowest == origin


def test_vectors_and_other_memory_layouts(tmp_path):
    path = tmp_path / "flow.vdb"
    vectors = np.random.default_rng(1).normal(size=(5, 6, 7, 3)).astype(np.float32)
    photonvdb.write_vdb(path, vectors, name="velocity")
    back, index_to_world, origin = photonvdb.read_vdb(path, "velocity")
    assert back.tobytes() == vectors.tobytes()
    np.testing.assert_array_equal(index_to_world, np.eye(4))
    assert origin == (0, 0, 0)
    turned = np.asfortranarray(vectors[..., 0].astype(np.float64))
    photonvdb.write_vdb(path, turned[:, ::-1])
    np.testing.assert_array_equal(photonvdb.read_vdb(path)[0], vectors[:, ::-1, :, 0])


def test_only_what_is_active_comes_back(tmp_path):
    path = tmp_path / "spot.vdb"
    array = np.zeros((20, 20, 20))
    array[4, 5, 6], array[7, 5, 6] = 1, 2
    photonvdb.write_vdb(path, array, origin=(10, 20, 30))
    back, _, origin = photonvdb.read_vdb(path)
    assert origin == (14, 25, 36)
    np.testing.assert_array_equal(back, np.array([1, 0, 0, 2]).reshape(4, 1, 1))
    photonvdb.write_vdb(path, 0 * array)
    assert photonvdb.read_vdb(path)[0].shape == (0, 0, 0)


def test_a_known_file_is_read_as_the_official_library_reads_it(root):
    folder = root / "tests/vdb"
    array, _, origin = photonvdb.read_vdb(folder / "fog_sphere_half.vdb")
    grid = json.loads((folder / "fog_sphere_half.json").read_text())["grids"][0]
    low, high = np.array(grid["bbox"])
    assert origin == tuple(low)
    assert array.shape == tuple(high - low + 1)
    inside = [s for s in grid["samples"] if np.all(low <= s["ijk"]) and np.all(s["ijk"] <= high)]
    assert len(inside) > 20
    for sample in inside:
        assert array[tuple(sample["ijk"] - low)] == np.float32(sample["value"])


def test_a_written_volume_renders(fog, tmp_path):
    to_world = np.diag([0.25, 0.25, 0.25, 1.0])
    photonvdb.write_vdb(tmp_path / "cube.vdb", np.ones((8, 8, 8)), to_world, (-4, -4, -4))
    fog["medium"] = {"kind": "vdb", "file": "cube.vdb", "density_scale": 1.0, "albedo": 0.5}
    fog["camera"].update(vertical_fov=1e-3, resolution=[1, 1])
    transmittance = photonvdb.render(fog, directory=tmp_path, photons=100)["transmittance"]
    # Seven cells between eight voxel centres, and half a cell's worth of the ramp to 0 at each end.
    np.testing.assert_allclose(-np.log(transmittance), 2.0, rtol=1e-5)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"array": np.zeros((2, 2))}, "array"),
        ({"array": np.zeros((2, 2, 2, 4))}, "array"),
        ({"array": np.ones((2, 2, 2)), "index_to_world": np.zeros((4, 4))}, "last row"),
        ({"array": np.ones((2, 2, 2)), "index_to_world": np.diag([1, 0, 1, 1.0])}, "transform"),
        ({"array": np.ones((2, 2, 2)), "origin": (2**31 - 1, 0, 0)}, "reach beyond"),
        ({"array": np.ones((2, 2, 2)), "compression": "lzma"}, "compression"),
        ({"array": np.ones((2, 2, 2)), "class_": "fog"}, "fog volume"),
    ],
)
def test_what_cannot_be_written_is_refused(tmp_path, arguments, words):
    with pytest.raises(photonvdb.Error, match=words):
        photonvdb.write_vdb(tmp_path / "no.vdb", **arguments)
    assert not (tmp_path / "no.vdb").exists()


def test_what_cannot_be_read_is_refused(tmp_path, root):
    with pytest.raises(FileNotFoundError, match="nothing.vdb"):
        photonvdb.read_vdb(tmp_path / "nothing.vdb")
    (tmp_path / "text.vdb").write_text("no volume")
    with pytest.raises(photonvdb.Error, match="not an OpenVDB file"):
        photonvdb.read_vdb(tmp_path / "text.vdb")
    with pytest.raises(photonvdb.Error, match="name one it holds"):
        photonvdb.read_vdb(root / "tests/vdb/smoke_blosc.vdb", "smok")
    wide = np.zeros((200_000, 1, 1))
    wide[[0, -1]] = 1
    photonvdb.write_vdb(tmp_path / "wide.vdb", wide)
    with pytest.raises(photonvdb.Error, match="200000 x 1 x 1 voxels needs"):
        photonvdb.read_vdb(tmp_path / "wide.vdb", max_memory=1e5)


def test_blackbodies_have_the_colours_of_the_planckian_locus():
    xyz = photonvdb.blackbody_xyz([[1000.0, 3000.0], [6500.0, 300.0]])
    assert xyz.shape == (2, 2, 3) and not xyz[1, 1].any()
    chromaticity = xyz[..., :2] / np.maximum(xyz.sum(axis=-1, keepdims=True), 1e-30)
    # Wyszecki and Stiles, Color Science, table 1(3.3.4).
    np.testing.assert_allclose(chromaticity, [[[0.6528, 0.3445], [0.4369, 0.4041]], [[0.3135, 0.3236], [0.0, 0.0]]], atol=1e-4)
    assert photonvdb.blackbody_xyz(1900).shape == (3,)
