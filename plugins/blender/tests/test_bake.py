"""`photonvdb bake`, and what Cycles makes of its file: the same picture as photonvdb's own, where scattering is isotropic."""

import subprocess

import bpy
import numpy as np
import photonvdb
import pytest

SCENE = """
[camera]
position = [0.0, 0.0, 3.5]
look_at = [0.0, 0.0, 0.0]
vertical_fov = 35.0
resolution = [48, 48]

[medium]
kind = "vdb"
file = "{file}"
density_scale = {density_scale}
albedo = 0.8

[[light]]
kind = "directional"
direction = [0.5, -1.0, -0.3]
irradiance = [3.0, 2.5, 2.0]

[photons]
count = 100_000
"""


def lit_material(density_scale):
    """What `photonvdb bake --help` says: emission beside absorption by density_scale times density, and no scattering."""
    material = bpy.data.materials.new("Lit")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    kinds = ("OutputMaterial", "AddShader", "VolumeAbsorption", "Emission", "Math", "Attribute", "Attribute")
    output, both, absorption, emission, product, density, light = (tree.nodes.new(f"ShaderNode{kind}") for kind in kinds)
    density.attribute_name, light.attribute_name = "density", "emission"
    absorption.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    product.operation, product.inputs[1].default_value = "MULTIPLY", density_scale
    for start, end in [
        (density.outputs["Fac"], product.inputs[0]),
        (product.outputs[0], absorption.inputs["Density"]),
        (light.outputs["Color"], emission.inputs["Color"]),
        (absorption.outputs[0], both.inputs[0]),
        (emission.outputs[0], both.inputs[1]),
        (both.outputs[0], output.inputs["Volume"]),
    ]:
        tree.links.new(start, end)
    return material


@pytest.mark.parametrize(("name", "density_scale"), [("smoke_plume", 20.0), ("smoke_plume", 3.0), ("cloud", 60.0)])
def test_cycles_shows_a_baked_volume_as_photonvdb_renders_it(stage, root, cli, tmp_path, name, density_scale):
    scene, lit = tmp_path / "scene.toml", tmp_path / f"{name}-{density_scale:g}.vdb"
    scene.write_text(SCENE.format(file=(root / "media" / f"{name}.vdb").as_posix(), density_scale=density_scale))
    subprocess.run([cli, "bake", scene, "-o", lit, "--quiet"], check=True)
    ours = photonvdb.render(scene)["rgba"][..., :3]
    stage.volume(lit, lit_material(density_scale))
    stage.camera.location, stage.camera.rotation_euler = (0.0, 0.0, 3.5), (0.0, 0.0, 0.0)
    theirs = stage.in_cycles(64)
    np.testing.assert_allclose(theirs.mean, ours.mean(axis=(0, 1)), rtol=0.05)
