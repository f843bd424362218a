"""The render engine: a depsgraph in, the passes of a picture out."""

import tempfile

import bpy
import numpy as np
import photonvdb

from . import film
from .refusal import Refused
from .scene import translated
from .settings import arguments, with_settings

#: Share of a pass that each stage begins at, and its length.
STAGES = {"trace": (0.0, 0.4), "build": (0.4, 0.1), "gather": (0.5, 0.5), "pass": (0.0, 0.0)}


class PhotonvdbRenderEngine(bpy.types.RenderEngine):
    """Volumetric photon mapping of volumes."""

    bl_idname = "PHOTONVDB"
    bl_label = "photonvdb"
    bl_use_preview = False
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False

    def update_render_passes(self, scene=None, renderlayer=None):
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        if renderlayer.use_pass_z:
            self.register_pass(scene, renderlayer, "Depth", 1, "Z", "VALUE")
        for name, channels, letters, kind, _ in film.wanted(renderlayer):
            self.register_pass(scene, renderlayer, name, channels, letters, kind)

    def render(self, depsgraph):
        try:
            with tempfile.TemporaryDirectory(prefix="photonvdb-") as directory:
                self.render_within(depsgraph, directory)
        except (Refused, photonvdb.Error, OSError) as error:
            self.report({"ERROR"}, str(error))
            self.error_set(str(error))

    def render_within(self, depsgraph, directory):
        """Renders with a directory for temporary files."""
        scene, view_layer = depsgraph.scene, depsgraph.view_layer
        self.update_stats("", "Reading the scene")
        found = translated(depsgraph, directory)
        for note in found.notes:
            self.report({"WARNING"}, note)
        rendering = photonvdb.render(
            with_settings(found.scene, scene.photonvdb),
            **arguments(scene),
            layers=film.costly_layers(view_layer),
            progress=Progress(self, scene.photonvdb),
        )
        pixels = film.passes(rendering, scene.render.film_transparent)
        self.show(pixels, found.frame, view_layer.name)

    def show(self, pixels, frame, layer_name):
        """Gives Blender the pixels of each pass."""
        # Blender's rows go from the bottom up.
        pictures = {name: np.ascontiguousarray(picture[frame.rows, frame.columns][::-1]) for name, picture in pixels.items()}
        result = self.begin_result(0, 0, *frame.size, layer=layer_name)
        for render_pass in result.layers[0].passes:
            if render_pass.name in pictures:
                render_pass.rect.foreach_set(pictures[render_pass.name].ravel())
        # What was made before a break is shown, too.
        self.end_result(result, cancel=self.test_break(), do_merge_results=True)


class Progress:
    """What Blender is told while the library works, and whether it may go on."""

    def __init__(self, engine, settings):
        self.engine = engine
        self.passes = settings.passes if settings.is_counted() else None

    def __call__(self, stage, fraction, passes, error):
        begin, length = STAGES[stage]
        done = begin + length * fraction
        text = f"{passes} passes" if stage == "pass" else f"{stage.title()}, pass {passes + 1}"
        if self.passes:
            done = min((passes + done) / self.passes, 1.0)
            text += f" of {self.passes}"
        if error is not None:
            text += f", error {100.0 * error:.2g} %"
        self.engine.update_progress(done)
        self.engine.update_stats("", text)
        return not self.engine.test_break()


def register():
    bpy.utils.register_class(PhotonvdbRenderEngine)


def unregister():
    bpy.utils.unregister_class(PhotonvdbRenderEngine)
