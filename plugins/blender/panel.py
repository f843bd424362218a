"""The settings in the properties editor, and Blender's own panels that go with them."""

import bpy

ENGINE = "PHOTONVDB"

#: Panels of EEVEE for what photonvdb reads, too.
BORROWED = {
    "DATA_PT_EEVEE_light",
    "EEVEE_WORLD_PT_surface",
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_NEXT_MATERIAL_PT_volume",
    "EEVEE_MATERIAL_PT_volume",
    "DATA_PT_spot",
}

#: Panels for what photonvdb has no part in.
FOREIGN = {"RENDER_PT_simplify", "RENDER_PT_freestyle", "VIEWLAYER_PT_freestyle", "DATA_PT_camera_dof", "DATA_PT_camera_dof_aperture"}


class PhotonvdbPanel:
    """A panel of the render properties."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"

    #: Names of the settings that it shows.
    shown = ()

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        for name in self.names(context.scene.photonvdb):
            column.prop(context.scene.photonvdb, name)

    def names(self, _):
        return self.shown


class PHOTONVDB_PT_photons(PhotonvdbPanel, bpy.types.Panel):
    bl_label = "Photons"
    shown = ("photons", "emission", "max_order", "seed")


class PHOTONVDB_PT_estimate(PhotonvdbPanel, bpy.types.Panel):
    bl_label = "Estimate"

    def names(self, settings):
        return ("gather", *(("k", "divisor") if settings.gather == "knn" else ()), "samples", "filter")


class PHOTONVDB_PT_limit(PhotonvdbPanel, bpy.types.Panel):
    bl_label = "Limit"

    def names(self, settings):
        return ("limit", {"PASSES": "passes", "ERROR": "target_error", "TIME": "time_budget"}[settings.limit])


class PHOTONVDB_PT_unsupported(PhotonvdbPanel, bpy.types.Panel):
    bl_label = "Compatibility"
    shown = ("unsupported",)


class PHOTONVDB_PT_passes(PhotonvdbPanel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        view_layer = context.view_layer
        column = layout.column(heading="Include")
        column.prop(view_layer, "use_pass_combined")
        column.prop(view_layer, "use_pass_z", text="Depth")
        for name in view_layer.photonvdb.bl_rna.properties.keys():
            if name.startswith("use_"):
                column.prop(view_layer.photonvdb, name)


PANELS = (PHOTONVDB_PT_photons, PHOTONVDB_PT_estimate, PHOTONVDB_PT_limit, PHOTONVDB_PT_unsupported, PHOTONVDB_PT_passes)


def compatible_panels():
    """Blender's panels that are of use here."""
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", ())
        of_use = "BLENDER_RENDER" in engines and panel.__name__ not in FOREIGN
        if of_use or panel.__name__ in BORROWED and engines:
            yield panel


def register():
    for panel in PANELS:
        bpy.utils.register_class(panel)
    for panel in compatible_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister():
    for panel in bpy.types.Panel.__subclasses__():
        getattr(panel, "COMPAT_ENGINES", set()).discard(ENGINE)
    for panel in reversed(PANELS):
        bpy.utils.unregister_class(panel)
