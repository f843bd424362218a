"""Settings of a scene and of a view layer, and what they are to the library."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty


class PhotonvdbSettings(bpy.types.PropertyGroup):
    """How a scene is rendered."""

    photons: IntProperty(
        name="Photons",
        description="Photons emitted per pass; 0: a million, or as many as a target error or a time budget wants",
        default=0,
        min=0,
        soft_max=100_000_000,
    )
    emission: EnumProperty(
        name="Emission",
        description="How photons are sampled at the lights",
        items=(
            ("stratified", "Stratified", "Random within strata"),
            ("sobol", "Sobol", "Scrambled Sobol points"),
            ("random", "Random", "Independent"),
        ),
        default="stratified",
    )
    seed: IntProperty(name="Seed", description="Seed of every random number", default=0, min=0)
    max_order: IntProperty(
        name="Scatterings", description="Scatterings that a photon is followed through", default=1000, min=1
    )
    gather: EnumProperty(
        name="Gather",
        description="How light scattered twice or more is gathered from photons",
        items=(
            ("auto", "Automatic", "Bounced paths where light scatters many times, else a lattice"),
            ("lattice", "Lattice", "The lengths that photons fly in cells"),
            ("knn", "Nearest photons", "The k photons nearest to a point: the classical photon map"),
            ("bounce", "Bounced paths", "Camera paths that bounce before they end in the lattice"),
        ),
        default="auto",
    )
    k: IntProperty(name="k", description="Photons of one estimate", default=50, min=1, max=1_000_000)
    divisor: EnumProperty(
        name="Divisor",
        description="What the k nearest photons count as",
        items=(
            ("k", "k", "All of them: reads too high by 1 / (k - 1)"),
            ("k-1", "k - 1", "Exact for random photons"),
            ("k-1/2", "k - 1/2", "Half of the k-th"),
            ("calibrated", "Calibrated", "Measured from the photons themselves"),
        ),
        default="k-1",
    )
    samples: IntProperty(name="Rays", description="Camera rays a pixel", default=4, min=1, max=65536)
    filter: EnumProperty(
        name="Filter",
        description="Whether multiple scattering is smoothed from pixel to pixel",
        items=(
            ("auto", "Automatic", "With a target error, a time budget or bounced paths"),
            ("on", "On", "As far as the noise taken away exceeds the measured bias"),
            ("off", "Off", "Never"),
        ),
        default="auto",
    )
    limit: EnumProperty(
        name="Until",
        description="When a render ends",
        items=(
            ("PASSES", "Passes", "So many passes were made"),
            ("ERROR", "Target error", "The estimated error is below the target"),
            ("TIME", "Time budget", "The time is over"),
        ),
        default="PASSES",
    )
    passes: IntProperty(name="Passes", description="Independent passes, whose mean the picture is", default=1, min=1)
    target_error: FloatProperty(
        name="Error",
        description="Root mean square error of the picture over its mean, estimated from the passes",
        subtype="PERCENTAGE",
        default=5.0,
        min=0.01,
        max=100.0,
    )
    time_budget: FloatProperty(
        name="Time", description="Seconds, of which at least one pass is made", subtype="TIME_ABSOLUTE", default=30.0, min=0.1
    )
    unsupported: EnumProperty(
        name="Unsupported",
        description="What becomes of objects that photonvdb cannot render, such as surfaces",
        items=(
            ("REFUSE", "Refuse", "Do not render, and name the first one"),
            ("LEAVE_OUT", "Leave out", "Render without them, and name them in warnings"),
        ),
        default="REFUSE",
    )

    def is_counted(self):
        """Whether it is known how many passes there will be."""
        return self.limit == "PASSES"


class PhotonvdbViewLayer(bpy.types.PropertyGroup):
    """Passes of a view layer beside Combined."""

    use_single_scatter: BoolProperty(name="Single Scatter", description="Light scattered once")
    use_multiple_scatter: BoolProperty(name="Multiple Scatter", description="Light scattered more often")
    use_emission: BoolProperty(name="Emission", description="Light seen directly: flames and the world, through the medium")
    use_transmittance: BoolProperty(name="Transmittance", description="Share of background light that passes, a channel")
    use_coverage: BoolProperty(name="Coverage", description="1 - mean transmittance: alpha, also where the film is not transparent")


def arguments(scene):
    """What of the settings are arguments of photonvdb.render."""
    settings = scene.photonvdb
    limits = {
        "PASSES": {"passes": settings.passes},
        "ERROR": {"target_error": settings.target_error / 100.0},
        "TIME": {"time_budget": settings.time_budget},
    }
    chosen = dict(limits[settings.limit], emission=settings.emission, seed=settings.seed)
    if settings.photons > 0:
        chosen["photons"] = settings.photons
    chosen["gather"] = settings.gather
    if settings.gather == "knn":
        chosen |= {"k": settings.k, "divisor": settings.divisor}
    if scene.render.threads_mode == "FIXED":
        chosen["threads"] = scene.render.threads
    return chosen


def with_settings(scene, settings):
    """A scene of the library with the settings that are keys of its file."""
    render = scene["render"] | {"samples_per_pixel": settings.samples, "filter": settings.filter}
    return scene | {"render": render, "photons": {"max_order": settings.max_order}}


def register():
    for group in (PhotonvdbSettings, PhotonvdbViewLayer):
        bpy.utils.register_class(group)
    bpy.types.Scene.photonvdb = PointerProperty(type=PhotonvdbSettings)
    bpy.types.ViewLayer.photonvdb = PointerProperty(type=PhotonvdbViewLayer)


def unregister():
    del bpy.types.ViewLayer.photonvdb, bpy.types.Scene.photonvdb
    for group in (PhotonvdbViewLayer, PhotonvdbSettings):
        bpy.utils.unregister_class(group)
