"""Layers of the library as passes of Blender."""

import numpy as np

#: Passes beside Combined: name, channels, their names, Blender's kind, and the property of a view layer that asks for it.
PASSES = (
    ("Single Scatter", 3, "RGB", "COLOR", "use_single_scatter"),
    ("Multiple Scatter", 3, "RGB", "COLOR", "use_multiple_scatter"),
    ("Emission", 3, "RGB", "COLOR", "use_emission"),
    ("Transmittance", 3, "RGB", "COLOR", "use_transmittance"),
    ("Coverage", 1, "X", "VALUE", "use_coverage"),
)


def wanted(view_layer):
    """The passes that a view layer asks for beside Combined and depth."""
    return [entry for entry in PASSES if getattr(view_layer.photonvdb, entry[4])]


def costly_layers(view_layer):
    """Layers that the library makes on demand."""
    return ["depth"] if view_layer.use_pass_z else []


def passes(rendering, is_transparent):
    """Pixels by the name of their pass, (height, width, channels), the topmost row first."""
    color, coverage = np.split(rendering["rgba"], [3], axis=2)
    alpha = coverage if is_transparent else np.ones_like(coverage)
    found = {
        "Combined": np.concatenate([color, alpha], axis=2),
        "Single Scatter": rendering["single_scatter"],
        "Multiple Scatter": rendering["multiple_scatter"],
        "Emission": rendering["emission"],
        "Transmittance": rendering["transmittance"],
        "Coverage": coverage,
    }
    if "Z" in rendering:
        # What is empty is as far as Blender's far away.
        found["Depth"] = np.minimum(rendering["Z"], np.float32(1e10))[..., None]
    return found
