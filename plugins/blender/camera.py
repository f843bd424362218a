"""The scene's camera as a pinhole with its view in the middle, and which part of its image is wanted."""

from math import atan, degrees
from typing import NamedTuple

from . import axes
from .refusal import Refused


class Frame(NamedTuple):
    """A camera, and the rows and columns of its image that are the picture."""

    camera: dict
    rows: slice
    columns: slice

    @property
    def size(self):
        """Width and height of the picture."""
        return self.columns.stop - self.columns.start, self.rows.stop - self.rows.start


def frame(depsgraph):
    """The frame of the scene's camera.

    A shifted view is cut out of a larger one around the axis, to which it lies to a quarter of a pixel; a render border out of the
    whole picture.
    """
    scene = depsgraph.scene
    settings = scene.render
    if scene.camera is None:
        raise Refused(scene.name, "there is no camera")
    camera_object = scene.camera.evaluated_get(depsgraph)
    camera, name = camera_object.data, camera_object.name
    if camera.type != "PERSP":
        raise Refused(name, f"cameras of type {camera.type.title()}; photonvdb's is a perspective one")
    if camera.dof.use_dof:
        raise Refused(name, "depth of field")
    if settings.use_multiview:
        raise Refused(scene.name, "stereoscopy")
    if settings.pixel_aspect_x != settings.pixel_aspect_y:
        raise Refused(scene.name, "pixels that are not square")
    width, height = (int(side * settings.resolution_percentage / 100) for side in (settings.resolution_x, settings.resolution_y))
    projection = camera_object.calc_matrix_camera(depsgraph, x=width, y=height)
    # Pixels, twice, by which the view's middle lies right of the axis and above it.
    right, up = round(projection[0][2] * width), round(projection[1][2] * height)
    whole_width, whole_height = width + abs(right), height + abs(up)
    left, top = max(right, 0), max(-up, 0)
    low_x, high_x, low_y, high_y = border(settings, width, height)
    matrix_world = camera_object.matrix_world
    position, turn = matrix_world.translation, matrix_world.to_3x3()
    pinhole = {
        "position": axes.point(position),
        "look_at": axes.point(position - turn.col[2].normalized()),
        "up": axes.point(turn.col[1].normalized()),
        "vertical_fov": 2.0 * degrees(atan(whole_height / height / projection[1][1])),
        "resolution": [whole_width, whole_height],
    }
    rows = slice(top + height - high_y, top + height - low_y)
    return Frame(pinhole, rows, slice(left + low_x, left + high_x))


def border(settings, width, height):
    """Lowest and highest column, and row from the bottom, of what is to be rendered."""
    if not settings.use_border:
        return 0, width, 0, height
    horizontal = int(settings.border_min_x * width), int(settings.border_max_x * width)
    return *horizontal, int(settings.border_min_y * height), int(settings.border_max_y * height)
