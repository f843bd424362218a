"""The integrator: what ``{'type': 'photonvdb'}`` becomes. It translates a scene, and photonvdb renders it."""

import tempfile
from contextlib import contextmanager

import mitsuba as mi
import photonvdb

from .errors import UnsupportedError
from .picture import fill_film
from .scene import check_variant, scene_file
from .settings import Settings


def register():
    """Registers the integrator for the variant that is set, and for those that will be."""
    mi.detail.add_variant_callback(lambda _old, _new: register_variant())
    if mi.variant() is not None:
        register_variant()


def register_variant():
    """Registers the integrator for the variant that is set, whose classes are its own."""

    class Integrator(mi.SamplingIntegrator):
        def __init__(self, props):
            with quiet():
                super().__init__(props)
            check_variant()
            self.settings = Settings(props)

        def render(self, scene, sensor=0, seed=0, spp=0, develop=True, evaluate=True):
            sensor = sensor if isinstance(sensor, mi.Sensor) else scene.sensors()[sensor]
            film = sensor.film()
            rendering = render(scene, sensor, self.settings, int(seed), spp)
            fill_film(film, rendering, self.settings.layers, self.settings.aov_names())
            if not develop:
                film.schedule_storage()
                return mi.TensorXf()
            return film.develop()

        def aov_names(self):
            return self.settings.aov_names()

        def render_forward(self, *_, **__):
            raise UnsupportedError("integrator photonvdb: images are not differentiable")

        def render_backward(self, *_, **__):
            raise UnsupportedError("integrator photonvdb: images are not differentiable")

        def to_string(self):
            return f"photonvdb[{self.settings.arguments | self.settings.keys}]"

    mi.register_integrator("photonvdb", Integrator)


@contextmanager
def quiet():
    """Mitsuba warns that Python is slow in scalar variants, which this integrator is not."""
    level = mi.log_level()
    mi.set_log_level(mi.LogLevel.Error)
    try:
        yield
    finally:
        mi.set_log_level(level)


def render(scene, sensor, settings, seed: int, spp: int):
    """The rendering of a Mitsuba scene; without ``spp`` the sampler says how many rays a pixel has."""
    film = sensor.film()
    if not film.rfilter().is_box_filter():
        mi.Log(mi.LogLevel.Info, f"photonvdb: the pixel filter is a box, in place of {film.rfilter()}")
    with tempfile.TemporaryDirectory(prefix="photonvdb-") as directory:
        tables = scene_file(scene, sensor, directory)
        tables |= settings.sections(spp or sensor.sampler().sample_count())
        return photonvdb.render(tables, seed=seed, directory=directory, **settings.arguments)
