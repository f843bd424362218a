"""Volume objects, which show an OpenVDB file, as media."""

import os

import bpy
from mathutils import Vector

from . import axes, blackbody
from .refusal import Refused
from .shader import optics

#: A unit vector that is turned to all axes alike: how Cycles measures the scale of an object.
DIAGONAL = Vector((1.0, 1.0, 1.0)).normalized()


def media(instance, directory):
    """The media of a depsgraph instance of a Volume; `directory` takes temporary files."""
    volume_object = instance.object
    volume, name = volume_object.data, volume_object.name
    file = path_of(volume_object, directory)
    grids = [grid.name for grid in volume.grids]
    shading = optics(material_of(volume_object), name, grids)
    matrix_world = instance.matrix_world.copy()
    density_change = density_change_of(volume, matrix_world)
    place = {"kind": "vdb", "file": file, "transform": {"matrix": axes.matrix(matrix_world)}}
    found = []
    if shading.absorbs() or shading.flame:
        found.append(place | scattering(shading, name, grids, density_change))
    if shading.blackbody:
        present(shading.blackbody[3], grids, name)
        glow = blackbody.media(shading.blackbody, place, density_change, directory)
        # Where all have one phase function, the library has a lattice.
        found += [medium | {"phase": shading.phase} for medium in glow]
    return found


def scattering(shading, name, grids, density_change):
    """The keys of what scatters, absorbs and burns."""
    if shading.absorbs() and shading.density is None:
        raise Refused(name, f"its density comes from no grid of the file, which has {', '.join(grids)}")
    sigma_t = shading.sigma_t
    if max(sigma_t) - min(sigma_t) > 1e-6 * max(sigma_t):
        raise Refused(name, "absorption is coloured: photonvdb's grids are grey, only their albedo is coloured")
    keys = {
        # What only glows has a density, of scale 0, all the same.
        "density": shading.density or present(shading.flame.grid, grids, name),
        "density_scale": sigma_t[1] * density_change,
        "albedo": shading.albedo(),
        "phase": shading.phase,
    }
    if shading.color:
        keys["color"] = present(shading.color, grids, name)
    if shading.flame:
        if shading.flame.grid is None:
            raise Refused(name, "it glows alike everywhere: lead a grid, such as flame, into Emission Strength")
        keys["flame"] = present(shading.flame.grid, grids, name)
        keys["flame_color"] = [channel * density_change for channel in shading.flame.color]
    return keys


def present(grid, grids, name):
    if grid not in grids:
        raise Refused(name, f'there is no grid "{grid}" in the file, which has {", ".join(grids)}')
    return grid


def material_of(volume_object):
    slots = volume_object.material_slots
    return slots[0].material if slots else None


def density_change_of(volume, matrix_world):
    """Density in object space thins as the object grows."""
    if volume.render.space == "WORLD":
        return 1.0
    length = (matrix_world.to_3x3() @ DIAGONAL).length
    return 1.0 / length if length > 0.0 else 1.0


def path_of(volume_object, directory):
    """The OpenVDB file of the frame at hand; what is packed or modified is written to `directory`."""
    volume, name = volume_object.data, volume_object.name
    modified = any(modifier.show_render for modifier in volume_object.modifiers)
    if not volume.grids.load():
        raise Refused(name, volume.grids.error_message or "its file cannot be read")
    if not len(volume.grids):
        raise Refused(name, "it has no grids")
    file = bpy.path.abspath(volume.grids.frame_filepath, library=volume.library)
    if not modified and not volume.packed_file and os.path.isfile(file):
        return file
    file = os.path.join(directory, f"{len(os.listdir(directory))}.vdb")
    if not volume.grids.save(file):
        raise Refused(name, volume.grids.error_message or "its grids cannot be written")
    return file
