"""A depsgraph as a scene of the library."""

from typing import NamedTuple

import bpy

from . import box, lights, volume, world
from .camera import Frame, frame
from .refusal import Refused

#: What can be seen, and would be missing from the picture.
SURFACES = (bpy.types.Mesh, bpy.types.Curve, bpy.types.MetaBall, bpy.types.PointCloud, bpy.types.Curves)


class Translated(NamedTuple):
    """A scene for the library, which of its image is the picture, and what is to be said of both."""

    scene: dict
    frame: Frame
    notes: list


def translated(depsgraph, directory):
    """What the depsgraph's scene is to the library; `directory` takes temporary files."""
    settings = depsgraph.scene.photonvdb
    notes = []
    framed = frame(depsgraph)
    media, lamps = things(depsgraph, directory, notes, settings.unsupported == "LEAVE_OUT")
    if not media:
        raise Refused(depsgraph.scene.name, "there is no volume to render")
    sky = world.environment(depsgraph.scene.world, directory)
    # Without light the picture is black, but has an alpha.
    lit = lamps + ([sky] if sky else []) or [{"kind": "environment", "radiance": 0.0}]
    scene = {
        "camera": framed.camera,
        "medium": media if len(media) > 1 else media[0],
        "light": lit,
        "render": {"background": "holdout" if depsgraph.scene.render.film_transparent else "visible"},
    }
    return Translated(scene, framed, notes)


def things(depsgraph, directory, notes, leaves_out):
    """Media and lights of all instances."""
    media, lamps = [], []
    for instance in depsgraph.object_instances:
        if not instance.show_self:
            continue
        try:
            content = instance.object.data
            if isinstance(content, bpy.types.Volume):
                check_visible(instance.object)
                media += volume.media(instance, directory)
            elif isinstance(content, bpy.types.Light):
                lamps += lights.lights(instance, notes)
            elif isinstance(content, SURFACES) and not is_empty(content):
                check_visible(instance.object)
                media += box.media(instance)
        except Refused as refused:
            if not leaves_out:
                raise
            notes.append(f"left out: {refused}")
    return media, lamps


def is_empty(geometry):
    return isinstance(geometry, bpy.types.Mesh) and not geometry.polygons


def check_visible(thing):
    """What Blender hides from some rays alone is no medium."""
    if thing.is_holdout:
        raise Refused(thing.name, "holdouts")
    if not all((thing.visible_camera, thing.visible_volume_scatter, thing.visible_shadow)):
        raise Refused(thing.name, "it is invisible to some kinds of rays, under Visibility, and not to others")
