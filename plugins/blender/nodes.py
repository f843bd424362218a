"""What the sockets of shader nodes say, as far as it is a number or colour times a grid."""

from typing import NamedTuple, Optional

from .refusal import Refused

#: Outputs of Volume Info, and the grids that they read.
VOLUME_INFO = {"Color": "color", "Density": "density", "Flame": "flame", "Temperature": "temperature"}


class Term(NamedTuple):
    """A colour, times the value of a grid where there is one."""

    color: tuple[float, float, float]
    grid: Optional[str] = None

    @property
    def value(self):
        """The number that sockets of numbers make of a colour."""
        return sum(weight * channel for weight, channel in zip((0.2126, 0.7152, 0.0722), self.color))

    def times(self, other):
        """The product; None of two grids, which is no term."""
        if self.grid and other.grid:
            return None
        return Term(tuple(a * b for a, b in zip(self.color, other.color)), self.grid or other.grid)


def link_of(socket):
    """What leads into a socket, reroutes skipped, or None."""
    links = [link for link in socket.links if not link.is_muted and link.is_valid]
    if not links:
        return None
    link = links[0]
    return link_of(link.from_node.inputs[0]) if link.from_node.type == "REROUTE" else link


def node_before(socket):
    """The node that leads into a socket, or None."""
    link = link_of(socket)
    return link.from_node if link else None


def output_of(tree):
    """The active output node of a material, light or world, or None."""
    return tree.get_output_node("CYCLES") if tree else None


def read(socket, name):
    """The term that a socket of the thing of that name is."""
    link = link_of(socket)
    if link is None:
        return Term(rgb(socket.default_value))
    node = link.from_node
    term = None
    if node.mute:
        pass
    elif node.type in ("VALUE", "RGB"):
        term = Term(rgb(link.from_socket.default_value))
    elif node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY" and link.from_socket.name != "Alpha":
        term = Term((1.0, 1.0, 1.0), node.attribute_name)
    elif node.type == "VOLUME_INFO":
        term = Term((1.0, 1.0, 1.0), VOLUME_INFO[link.from_socket.name])
    elif node.type in ("MATH", "VECT_MATH") and node.operation == "MULTIPLY" and not getattr(node, "use_clamp", False):
        term = read(node.inputs[0], name).times(read(node.inputs[1], name))
    elif node.type == "VECT_MATH" and node.operation == "SCALE":
        term = read(node.inputs[0], name).times(read(node.inputs["Scale"], name))
    if term is None:
        raise Refused(name, f'node "{node.name}" before {socket.name} is more than a number times a grid')
    return term


def constant(socket, name):
    """The colour of a socket that no grid leads into."""
    term = read(socket, name)
    if term.grid is not None:
        raise Refused(name, f"{socket.name} is the same everywhere to photonvdb, and cannot come from a grid")
    return term.color


def number(socket, name):
    """The number of a socket that no grid leads into."""
    return Term(constant(socket, name)).value


def rgb(value):
    """A number or a colour with or without alpha, as three numbers."""
    if hasattr(value, "__len__"):
        return tuple(value)[:3]
    return (value,) * 3
