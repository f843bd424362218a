"""Pictures: a rendering put into Mitsuba's film, which makes of it what it makes of its own."""

import mitsuba as mi
import numpy as np


def fill_film(film, rendering, layers, aov_names):
    """Puts the film's crop of a rendering, and the named layers of it, into the film."""
    channel_count = film.prepare(aov_names)
    (left, top), (width, height) = film.crop_offset(), film.crop_size()
    whole = [rendering["rgba"], np.ones((*rendering["rgba"].shape[:2], 1), np.float32)]
    if channel_count - len(aov_names) == 4:
        whole[0] = whole[0][..., :3]
    whole += [rendering[layer] for layer in layers]
    pixels = np.concatenate(whole, axis=2)[top : top + height, left : left + width]
    film.clear()
    film.put_block(mi.ImageBlock(mi.TensorXf(np.ascontiguousarray(pixels)), film.crop_offset()))
