"""Lights, whose watts are power: a point of P watts has P / (4 pi) W/sr, a flat light P / (pi area) W/(m^2 sr), a sun irradiance."""

from math import acos, asin, cos, degrees, pi, radians, sqrt

from mathutils import Vector

from . import axes
from .nodes import constant, node_before, number, output_of
from .refusal import Refused

#: Spots that make up one with a soft edge, and strips that make up a disk.
EDGE_STEPS = 8
DISK_STRIPS = 8

#: Lights of a size: Blender's are hidden from the camera, unless Ray Visibility shows them.
EXTENDED = ("quad", "sphere")

#: Widest sun that is taken for parallel light [rad].
WIDEST_SUN = radians(3.0)


def lights(instance, notes):
    """The lights of a depsgraph instance of a Light. `notes` takes what is rendered a little otherwise."""
    light_object = instance.object
    light, name = light_object.data, light_object.name
    if not light_object.visible_volume_scatter:
        return []
    if not light.use_shadow:
        raise Refused(name, "lights without shadows")
    if not getattr(light, "normalize", True):
        raise Refused(name, "power by area: switch Normalize on")
    color = color_of(light, name)
    makers = {"POINT": point, "SPOT": spot, "SUN": sun, "AREA": area}
    made = makers[light.type](light, instance.matrix_world.copy(), color, name, notes)
    return [lamp | {"visible": light_object.visible_camera} if lamp["kind"] in EXTENDED else lamp for lamp in made]


def color_of(light, name):
    """Power or irradiance, a channel."""
    power = light.energy * 2.0 ** getattr(light, "exposure", 0.0)
    tint = light.temperature_color if getattr(light, "use_temperature", False) else (1.0,) * 3
    shade = (1.0,) * 3
    if getattr(light, "use_nodes", True) and light.node_tree:
        output = output_of(light.node_tree)
        node = node_before(output.inputs["Surface"]) if output else None
        if node is None:
            return (0.0,) * 3
        if node.type != "EMISSION" or node.mute:
            raise Refused(name, f'node "{node.name}" is no Emission')
        strength = number(node.inputs["Strength"], name)
        shade = tuple(strength * channel for channel in constant(node.inputs["Color"], name))
    return tuple(max(power * a * b * c, 0.0) for a, b, c in zip(light.color, tint, shade))


def point(light, matrix_world, color, name, notes):
    position, radius = axes.point(matrix_world.translation), light.shadow_soft_size
    if radius == 0.0:
        return [{"kind": "point", "position": position, "intensity": divided(color, 4.0 * pi)}]
    # Blender takes no notice of the object's scale here.
    radiance = divided(color, 4.0 * pi * pi * radius * radius)
    return [{"kind": "sphere", "center": position, "radius": radius, "radiance": radiance}]


def sun(light, matrix_world, color, name, notes):
    if light.angle > WIDEST_SUN:
        raise Refused(name, f"a sun of {degrees(light.angle):.3g} degrees: photonvdb's are parallel; 3 degrees pass for it")
    return [{"kind": "directional", "direction": axes.point(forward(matrix_world)), "irradiance": list(color)}]


def spot(light, matrix_world, color, name, notes):
    """Full within the cone but for its edge, where Blender's is a smoothstep of the cosine: spots one in another draw it in angles."""
    if light.use_square:
        raise Refused(name, "square spots")
    scales = sorted(matrix_world.to_scale())
    if scales[2] - scales[0] > 1e-4 * scales[2]:
        raise Refused(name, "a spot whose scale differs from axis to axis")
    if light.shadow_soft_size > 0.0:
        notes.append(f'"{name}": rendered as a point, without its radius')
    intensity = divided(color, 4.0 * pi)
    position, cone = matrix_world.translation, 0.5 * light.spot_size
    shape = {
        "kind": "spot",
        "position": axes.point(position),
        "look_at": axes.point(position + forward(matrix_world)),
    }
    edge = max((1.0 - cos(cone)) * light.spot_blend, 0.0)
    if edge < 1e-4:
        return [shape | {"intensity": intensity, "cone_angle": degrees(cone)}]
    inner = acos(min(cos(cone) + edge, 1.0))
    angles = [cone + (inner - cone) * step / EDGE_STEPS for step in range(EDGE_STEPS + 1)]
    reached = [smoothstep((cos(angle) - cos(cone)) / edge) for angle in angles]
    return [
        shape
        | {
            "intensity": [channel * (reached[step + 1] - reached[step]) for channel in intensity],
            "cone_angle": degrees(angles[step]),
            "falloff_angle": degrees(angles[step + 1]),
        }
        for step in range(EDGE_STEPS)
    ]


def smoothstep(x):
    x = min(max(x, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


def area(light, matrix_world, color, name, notes):
    if light.spread < radians(179.9):
        raise Refused(name, "area lights of less than 180 degrees of spread")
    wide, high = light.size, light.size_y if light.shape in ("RECTANGLE", "ELLIPSE") else light.size
    round_shape = light.shape in ("DISK", "ELLIPSE")
    strips = disk_strips() if round_shape else [(-0.5, 0.5, 0.5)]
    quads = []
    total = 0.0
    for low, top, half in strips:
        # It shines along -z: v x u.
        corner = Vector((-half * wide, low * high, 0.0))
        edge_v, edge_u = Vector((2.0 * half * wide, 0.0, 0.0)), Vector((0.0, (top - low) * high, 0.0))
        turn = matrix_world.to_3x3()
        quads.append((matrix_world @ corner, turn @ edge_u, turn @ edge_v))
        total += quads[-1][1].cross(quads[-1][2]).length
    if total == 0.0:
        raise Refused(name, "its area is 0")
    # A mirrored light shines to where its own axis points, which is not where its edges' product does.
    mirrored = matrix_world.determinant() < 0.0
    radiance = divided(color, pi * total)
    return [
        {
            "kind": "quad",
            "corner": axes.point(corner),
            "edge_u": axes.point(v if mirrored else u),
            "edge_v": axes.point(u if mirrored else v),
            "radiance": radiance,
        }
        for corner, u, v in quads
    ]


def disk_strips():
    """Strips that cover a disk of diameter 1: lowest and highest y, and the half width that gives each the disk's area there."""
    edges = [-0.5 + step / DISK_STRIPS for step in range(DISK_STRIPS + 1)]

    def below(y):
        return 0.25 * (asin(2.0 * y) + 2.0 * y * sqrt(max(1.0 - 4.0 * y * y, 0.0)))

    return [(low, top, 0.5 * (below(top) - below(low)) / (top - low)) for low, top in zip(edges, edges[1:])]


def forward(matrix_world):
    return -matrix_world.to_3x3().col[2].normalized()


def divided(color, by):
    return [channel / by for channel in color]
