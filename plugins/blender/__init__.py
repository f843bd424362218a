"""photonvdb as a render engine of Blender: volumes, lights, world and camera of a scene go to the library, its layers come back."""

from . import engine, panel, settings


def register():
    settings.register()
    engine.register()
    panel.register()


def unregister():
    panel.unregister()
    engine.unregister()
    settings.unregister()
