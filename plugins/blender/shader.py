"""Volume shaders as media, in Cycles' meaning of their sockets.

Principled Volume of density d, colour c and absorption colour a, a channel each:

    sigma_s = d c        sigma_a = d max(1 - c, 0) max(1 - sqrt(a), 0)

so that with the default, black, sigma_t is d and c the albedo. Emission is an emissivity [W/(m^3 sr)] that density has no part in.
"""

from dataclasses import dataclass, field
from math import sqrt
from typing import Optional

from .nodes import Term, constant, node_before, number, output_of, read
from .refusal import Refused

BLACK = (0.0, 0.0, 0.0)
ISOTROPIC = {"kind": "isotropic"}


@dataclass
class Optics:
    """What a volume shader does to light, where its density is 1."""

    sigma_s: tuple = BLACK
    sigma_t: tuple = BLACK
    #: The grid that sigma_s and sigma_t are multiplied by.
    density: Optional[str] = None
    #: The grid that sigma_s is further multiplied by.
    color: Optional[str] = None
    phase: dict = field(default_factory=lambda: dict(ISOTROPIC))
    #: Emissivity.
    flame: Optional[Term] = None
    #: Intensity, tint, kelvin where the grid is 1, and the grid.
    blackbody: Optional[tuple] = None

    def albedo(self):
        """sigma_s / sigma_t, a channel."""
        return [s / t if t > 0.0 else 0.0 for s, t in zip(self.sigma_s, self.sigma_t)]

    def scatters(self):
        return any(self.sigma_s)

    def absorbs(self):
        return any(self.sigma_t)


def optics(material, name, grids):
    """Optics of a material's volume (None: Blender's default one); `grids` are the names of those that there are."""
    if material is None:
        return Optics((0.5,) * 3, (1.0,) * 3, "density" if "density" in grids else None)
    output = output_of(material.node_tree)
    shader = node_before(output.inputs["Volume"]) if output else None
    if shader is None:
        return Optics()
    return read_shader(shader, f'{name}", material "{material.name}', grids)


def read_shader(node, name, grids):
    """Optics of a shader node and of what it adds."""
    readers = {
        "PRINCIPLED_VOLUME": principled,
        "VOLUME_SCATTER": scatter,
        "VOLUME_ABSORPTION": absorption,
        "EMISSION": emission,
    }
    if node.mute:
        raise Refused(name, f'node "{node.name}" is muted')
    if node.type == "ADD_SHADER":
        parts = [node_before(socket) for socket in node.inputs]
        parts = [read_shader(part, name, grids) for part in parts if part is not None]
        return added(parts, name)
    if node.type not in readers:
        known = "Principled Volume, Volume Scatter, Volume Absorption, Emission and Add Shader"
        raise Refused(name, f'node "{node.name}" is none of {known}')
    return readers[node.type](node, name, grids)


def principled(node, name, grids):
    sockets = node.inputs
    density = read(sockets["Density"], name)
    attribute = sockets["Density Attribute"].default_value
    if attribute in grids:
        density = density.times(Term((1.0,) * 3, attribute))
        if density is None:
            raise Refused(name, 'density is multiplied by two grids: clear Density Attribute, or what leads into Density')
    color = read(sockets["Color"], name)
    attribute = sockets["Color Attribute"].default_value
    if attribute in grids:
        color = color.times(Term((1.0,) * 3, attribute))
        if color is None:
            raise Refused(name, "colour is multiplied by two grids: clear Color Attribute, or what leads into Color")
    absorption_color = constant(sockets["Absorption Color"], name)
    if color.grid and any(absorption_color):
        raise Refused(name, "an absorption colour that is not black goes with a colour, not with a grid of colours")
    scale = max(density.value, 0.0)
    sigma_s = tuple(scale * max(c, 0.0) for c in color.color)
    sigma_a = tuple(
        scale * max(1.0 - c, 0.0) * max(1.0 - sqrt(max(a, 0.0)), 0.0) for c, a in zip(color.color, absorption_color)
    )
    sigma_t = (scale,) * 3 if color.grid else tuple(s + a for s, a in zip(sigma_s, sigma_a))
    found = Optics(sigma_s, sigma_t, density.grid, color.grid, henyey_greenstein(number(sockets["Anisotropy"], name)))
    strength = read(sockets["Emission Strength"], name)
    found.flame = glow(strength, read(sockets["Emission Color"], name), name)
    found.blackbody = blackbody(sockets, name, grids)
    return found


def blackbody(sockets, name, grids):
    intensity = number(sockets["Blackbody Intensity"], name)
    if intensity <= 0.0:
        return None
    temperature = read(sockets["Temperature"], name)
    attribute = sockets["Temperature Attribute"].default_value
    if attribute in grids:
        temperature = temperature.times(Term((1.0,) * 3, attribute))
    if temperature is None or temperature.grid is None:
        raise Refused(name, "a blackbody takes its temperature from one grid")
    return intensity, constant(sockets["Blackbody Tint"], name), temperature.value, temperature.grid


def scatter(node, name, _):
    sockets = node.inputs
    density, color = read(sockets["Density"], name), constant(sockets["Color"], name)
    sigma_s = tuple(max(density.value, 0.0) * c for c in color)
    return Optics(sigma_s, sigma_s, density.grid, None, phase(node, name))


def absorption(node, name, _):
    density, color = read(node.inputs["Density"], name), constant(node.inputs["Color"], name)
    sigma_t = tuple(max(density.value, 0.0) * max(1.0 - c, 0.0) for c in color)
    return Optics(BLACK, sigma_t, density.grid)


def emission(node, name, _):
    return Optics(flame=glow(read(node.inputs["Strength"], name), read(node.inputs["Color"], name), name))


def glow(strength, color, name):
    """Emissivity of a strength and a colour, or None where there is none."""
    if not any(strength.color) or not any(color.color):
        return None
    if color.grid:
        raise Refused(name, "a grid of emission colours; photonvdb takes a grid for Emission Strength")
    return strength._replace(color=(strength.value,) * 3).times(color)


def phase(node, name):
    """The phase function of Volume Scatter."""
    kind = getattr(node, "phase", "HENYEY_GREENSTEIN")
    sockets = node.inputs
    if kind == "HENYEY_GREENSTEIN":
        return henyey_greenstein(number(sockets["Anisotropy"], name))
    if kind == "RAYLEIGH":
        return {"kind": "draine", "g": 0.0, "alpha": 1.0}
    if kind == "DRAINE":
        g, alpha = number(sockets["Anisotropy"], name), number(sockets["Alpha"], name)
        return {"kind": "draine", "g": g, "alpha": alpha}
    if kind == "MIE":
        return {"kind": "droplets", "diameter_um": number(sockets["Diameter"], name)}
    raise Refused(name, f"no phase function of {kind.replace('_', ' ').title()}")


def henyey_greenstein(g):
    return {"kind": "henyey-greenstein", "g": g} if g else dict(ISOTROPIC)


def added(parts, name):
    """Several optics at one place."""
    solid = [part for part in parts if part.absorbs()]
    if any(part.density != solid[0].density for part in solid):
        raise Refused(name, "shaders of several density grids are added")
    scattering = [part for part in solid if part.scatters()]
    if any(part.phase != scattering[0].phase for part in scattering):
        raise Refused(name, "shaders of several phase functions are added")
    colors = {part.color for part in scattering}
    if len(solid) > 1 and colors - {None}:
        raise Refused(name, "a grid of colours is added to other shaders")
    glowing = {
        kind: [getattr(part, kind) for part in parts if getattr(part, kind) is not None] for kind in ("flame", "blackbody")
    }
    if any(len(found) > 1 for found in glowing.values()):
        raise Refused(name, "several emissions are added")
    total = Optics(flame=next(iter(glowing["flame"]), None), blackbody=next(iter(glowing["blackbody"]), None))
    total.sigma_s = tuple(sum(channel) for channel in zip(BLACK, *(part.sigma_s for part in solid)))
    total.sigma_t = tuple(sum(channel) for channel in zip(BLACK, *(part.sigma_t for part in solid)))
    if solid:
        total.density, total.color = solid[0].density, next(iter(colors), None)
    if scattering:
        total.phase = scattering[0].phase
    return total
