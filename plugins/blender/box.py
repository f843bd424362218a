"""Meshes whose material is a volume as homogeneous media: boxes along the axes of the world."""

from mathutils import Vector

from .nodes import node_before, output_of
from .refusal import Refused
from .shader import optics

#: Largest distance of a corner from where it belongs, of the box's size.
TOLERANCE = 1e-4


def media(instance):
    """The media of a depsgraph instance of a mesh."""
    mesh_object = instance.object
    name = mesh_object.name
    materials = {slot.material for slot in mesh_object.material_slots}
    if len(materials) != 1 or not is_volume(next(iter(materials))):
        raise Refused(name, "it is a surface, and photonvdb renders volumes alone")
    shading = optics(materials.pop(), name, [])
    if shading.density or shading.color:
        raise Refused(name, f'a mesh has no grid "{shading.density or shading.color}"')
    if shading.flame or shading.blackbody:
        raise Refused(name, "the volume of a mesh cannot glow")
    if not shading.absorbs():
        return []
    low, high = corners(mesh_object.data, instance.matrix_world, name)
    bounds = {"min": [low.x, low.z, -high.y], "max": [high.x, high.z, -low.y]}
    keys = {"sigma_t": list(shading.sigma_t), "albedo": shading.albedo(), "phase": shading.phase}
    return [{"kind": "homogeneous", "bounds": bounds} | keys]


def is_volume(material):
    """Whether a material has a volume and no surface."""
    output = output_of(material.node_tree) if material else None
    return output is not None and node_before(output.inputs["Surface"]) is None and bool(node_before(output.inputs["Volume"]))


def corners(mesh, matrix_world, name):
    """Lowest and highest corner of a mesh that is a box along the axes of the world."""
    places = [matrix_world @ vertex.co for vertex in mesh.vertices]
    low = Vector(min(place[axis] for place in places) for axis in range(3))
    high = Vector(max(place[axis] for place in places) for axis in range(3))
    reach = TOLERANCE * (high - low).length
    at_corner = all(min(abs(p[i] - low[i]), abs(p[i] - high[i])) <= reach for p in places for i in range(3))
    if len(places) != 8 or not at_corner:
        raise Refused(name, "a mesh of volume must be a box along the axes of the world")
    return low, high
