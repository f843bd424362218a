"""The world's background as an environment: a colour, or an equirectangular image about the vertical."""

from math import degrees

from .environment_image import write_exr
from .nodes import constant, link_of, node_before, number, output_of
from .refusal import Refused

#: The library has the middle of an image along its -z, Blender along +x.
QUARTER_TURN = -90.0


def environment(world, directory):
    """The light that a world is, or None where it is black; `directory` takes a temporary file."""
    if world is None:
        return None
    name = world.name
    if not (getattr(world, "use_nodes", True) and world.node_tree):
        return even(world.color)
    output = output_of(world.node_tree)
    if output is None:
        return None
    if node_before(output.inputs["Volume"]):
        raise Refused(name, "the volume of a world")
    shader = node_before(output.inputs["Surface"])
    if shader is None:
        return None
    if shader.type not in ("BACKGROUND", "EMISSION") or shader.mute:
        raise Refused(name, f'node "{shader.name}" is no Background')
    strength = number(shader.inputs["Strength"], name)
    texture = node_before(shader.inputs["Color"])
    if texture is None or texture.type != "TEX_ENVIRONMENT":
        return even(tuple(strength * channel for channel in constant(shader.inputs["Color"], name)))
    if texture.projection != "EQUIRECTANGULAR" or texture.mute or texture.image is None:
        raise Refused(name, f'node "{texture.name}" has no equirectangular image')
    return {
        "kind": "environment",
        "file": write_exr(texture.image, directory, name),
        "scale": max(strength, 0.0),
        "rotation": QUARTER_TURN + turn_of(texture, name),
    }


def even(color):
    radiance = [max(channel, 0.0) for channel in color]
    return {"kind": "environment", "radiance": radiance} if any(radiance) else None


def turn_of(texture, name):
    """Degrees about the vertical, counter-clockwise, that a Mapping node turns an image by."""
    link = link_of(texture.inputs["Vector"])
    if link is None:
        return 0.0
    mapping, turn = link.from_node, (0.0,) * 3
    if mapping.type == "MAPPING":
        # Vectors and normals have no location.
        location, rotation, scale = (mapping.inputs.get(key) for key in ("Location", "Rotation", "Scale"))
        fixed = not any(link_of(socket) for socket in (location, rotation, scale) if socket)
        moved = location is not None and any(location.default_value)
        turn = rotation.default_value
        if not fixed or moved or any(turn[:2]) or tuple(scale.default_value) != (1.0,) * 3:
            raise Refused(name, f'node "{mapping.name}" does more than turn about z')
        # A texture mapping is the inverse of a point mapping.
        turn = [-angle for angle in turn] if mapping.vector_type == "TEXTURE" else turn
        link = link_of(mapping.inputs["Vector"])
    if link is None or link.from_node.type != "TEX_COORD" or link.from_socket.name != "Generated":
        raise Refused(name, "an environment image goes by Generated texture coordinates")
    return -degrees(turn[2])
