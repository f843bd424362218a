"""The add-on in a Blender without a window, and scenes of one volume, one light and one camera to render in it and in Cycles."""

import importlib.util
import math
import os
import pathlib
import shutil
import struct
import sys

import numpy as np
import pytest

bpy = pytest.importorskip("bpy", reason="Blender as a Python module is not installed: pip install bpy")
pytest.importorskip("photonvdb", reason="the module photonvdb is not installed: pip install ./plugins/python")

from mathutils import Vector  # noqa: E402  (comes with bpy)

ROOT = pathlib.Path(__file__).resolve().parents[3]
NAME = "photonvdb_blender"


def load_add_on():
    """The add-on's package, under a name of its own."""
    if NAME not in sys.modules:
        folder = ROOT / "plugins/blender"
        spec = importlib.util.spec_from_file_location(NAME, folder / "__init__.py", submodule_search_locations=[str(folder)])
        sys.modules[NAME] = module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    return sys.modules[NAME]


class Stage:
    """A Blender scene, empty and black but for a camera."""

    def __init__(self, directory):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.directory = directory
        self.scene = bpy.context.scene
        self.scene.render.resolution_x = self.scene.render.resolution_y = 48
        if hasattr(self.scene.render.image_settings, "media_type"):  # Blender 5
            self.scene.render.image_settings.media_type = "MULTI_LAYER_IMAGE"
            self.scene.render.image_settings.use_exr_interleave = True
        self.scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
        self.scene.render.image_settings.color_depth = "32"
        self.scene.render.image_settings.exr_codec = "NONE"
        self.scene.world = bpy.data.worlds.new("World")
        self.scene.world.use_nodes = True
        self.background = self.scene.world.node_tree.nodes["Background"].inputs
        self.background["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
        self.camera = self.add("Camera", bpy.data.cameras.new("Camera"), (0.0, -6.0, 1.0))
        self.camera.data.sensor_fit = "VERTICAL"
        self.camera.data.angle = math.radians(35.0)
        self.scene.camera = self.camera

    def add(self, name, content, position=(0.0, 0.0, 0.0), target=(0.0, 0.0, 0.0)):
        """An object that looks at a target along its -z axis."""
        thing = bpy.data.objects.new(name, content)
        self.scene.collection.objects.link(thing)
        thing.location = position
        way = Vector(target) - Vector(position)
        if way.length > 0.0:
            thing.rotation_euler = way.to_track_quat("-Z", "Y").to_euler()
        return thing

    def light(self, kind, position=(1.0, -2.0, 2.5), energy=100.0, **properties):
        light = bpy.data.lights.new(kind.title(), kind)
        light.energy = energy
        for name, value in {"shadow_soft_size": 0.0, **properties}.items():
            if hasattr(light, name):
                setattr(light, name, value)
        return self.add(kind.title(), light, position)

    def sky(self, *color, strength=1.0):
        self.background["Color"].default_value = (*color, 1.0)
        self.background["Strength"].default_value = strength

    def material(self, kind="ShaderNodeVolumePrincipled", **sockets):
        """A material of one volume shader; underscores of socket names stand for spaces."""
        material = bpy.data.materials.new("Volume")
        material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        output, shader = nodes.new("ShaderNodeOutputMaterial"), nodes.new(kind)
        material.node_tree.links.new(shader.outputs[0], output.inputs["Volume"])
        for name, value in sockets.items():
            shader.inputs[name.replace("_", " ")].default_value = value
        return material

    def volume(self, file, material=None, name="Smoke"):
        """A Volume object of a file, thick smoke unless a material is given."""
        volume = bpy.data.volumes.new(name)
        volume.filepath = str(file)
        thick = {"Density": 20.0, "Color": (0.8, 0.8, 0.8, 1.0)}
        volume.materials.append(material or self.material(**thick))
        return self.add(name, volume)

    def box(self, material=None, size=2.0, name="Box"):
        bpy.ops.mesh.primitive_cube_add(size=size)
        box = bpy.context.object
        box.name = name
        box.data.materials.append(material or self.material(Color=(0.8, 0.8, 0.8, 1.0)))
        return box

    def in_cycles(self, samples=256):
        """Passes that Cycles renders, by name."""
        self.scene.render.engine = "CYCLES"
        cycles = self.scene.cycles
        cycles.samples, cycles.seed = samples, 1
        cycles.use_denoising = cycles.use_adaptive_sampling = False
        cycles.max_bounces = cycles.volume_bounces = 128
        cycles.sample_clamp_indirect = cycles.sample_clamp_direct = 0.0
        cycles.pixel_filter_type = "BOX"
        return self.rendered()

    def in_photonvdb(self, photons=200_000, **settings):
        """Passes that the add-on renders, by name."""
        self.scene.render.engine = "PHOTONVDB"
        for name, value in {"photons": photons, **settings}.items():
            setattr(self.scene.photonvdb, name, value)
        return self.rendered()

    def rendered(self):
        path = self.directory / "render.exr"
        path.unlink(missing_ok=True)
        self.scene.render.filepath = str(path)
        bpy.ops.render.render(write_still=True)
        return Layers(path)


class Layers:
    """The passes of a file that Blender wrote: (height, width, channels), the topmost row first."""

    def __init__(self, path):
        self.passes = read_exr(path)

    def __getitem__(self, name):
        return self.passes[name]

    @property
    def color(self):
        return self.passes["Combined"][..., :3]

    @property
    def mean(self):
        return self.color.mean(axis=(0, 1), dtype=np.float64)


def read_exr(path):
    """The passes of an uncompressed OpenEXR file of 32-bit floats, which Blender names `layer.pass.channel`."""
    content = path.read_bytes()
    assert struct.unpack_from("<2i", content)[0] == 20000630
    place, attributes = 8, {}
    while content[place]:
        name, kind, rest = content[place : place + 600].split(b"\0", 2)
        begin = place + len(name) + len(kind) + 6
        (length,) = struct.unpack_from("<i", content, begin - 4)
        attributes[name] = content[begin : begin + length]
        place = begin + length
    assert attributes[b"compression"] == b"\0"
    left, top, right, bottom = struct.unpack("<4i", attributes[b"dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    channels, names = attributes[b"channels"], []
    while channels[0]:
        name, channels = channels.split(b"\0", 1)
        assert struct.unpack_from("<i", channels)[0] == 2, "32-bit floats"
        names.append(name.decode())
        channels = channels[16:]
    first = place + 1 + 8 * height
    rows = np.frombuffer(content, np.uint8, offset=first).reshape(height, -1)[:, 8:]
    rows = np.ascontiguousarray(rows).view("<f4").reshape(height, len(names), width)
    passes = {}
    for number, name in enumerate(names):
        _, pass_name, letter = name.split(".")
        passes.setdefault(pass_name, {})[letter] = rows[:, number]
    return {
        name: np.stack([planes[letter] for letter in sorted(planes, key="RGBAXZ".index)], axis=-1)
        for name, planes in passes.items()
    }


@pytest.fixture(scope="session")
def add_on():
    return load_add_on()


@pytest.fixture
def stage(add_on, tmp_path):
    """An empty scene, with the add-on registered."""
    add_on.register()
    yield Stage(tmp_path)
    add_on.unregister()


@pytest.fixture
def root():
    return ROOT


@pytest.fixture
def smoke():
    return ROOT / "media/smoke_plume.vdb"


@pytest.fixture
def fire():
    return ROOT / "media/fire.vdb"


@pytest.fixture
def cli():
    """The command line of the same version."""
    path = os.environ.get("PHOTONVDB_CLI") or shutil.which("photonvdb")
    if path is None:
        pytest.skip("no photonvdb command: set PHOTONVDB_CLI")
    return path
