"""Renders smoke in a grid with photonvdb and with Mitsuba's volpath, and writes both side by side: python smoke.py [PICTURE.png]"""

import sys
import time

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
import photonvdb_mitsuba  # noqa: F401


def smoke(count=64):
    """Densities of a puff of smoke: (z, y, x, channel), zeros in the outermost voxels."""
    z, y, x = np.meshgrid(*[np.linspace(-1, 1, count)] * 3, indexing="ij")
    ripples = np.sin(7 * x + 3 * np.sin(4 * y)) * np.sin(6 * y + 2 * z) * np.sin(8 * z - 2 * x)
    density = np.clip(1.2 - 1.6 * np.sqrt(x**2 + y**2 + z**2) + 0.5 * ripples, 0, 1)
    density[[0, -1]] = density[:, [0, -1]] = density[:, :, [0, -1]] = 0
    return density[..., None].astype(np.float32)


def scene():
    """The puff under a blue sky, with a sun from the upper left."""
    place = mi.ScalarTransform4f()
    return {
        "type": "scene",
        "camera": {
            "type": "perspective",
            "fov": 34,
            "to_world": place.look_at([0, 0.5, 4], [0, 0, 0], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": 192, "height": 192, "rfilter": {"type": "box"}},
        },
        "puff": {
            "type": "cube",
            "bsdf": {"type": "null"},
            "interior": {
                "type": "heterogeneous",
                "sigma_t": {
                    "type": "gridvolume",
                    "grid": mi.VolumeGrid(smoke()),
                    "to_world": place.translate(-1).scale(2),
                },
                "scale": 15.0,
                "albedo": {"type": "rgb", "value": [0.97, 0.95, 0.9]},
                "phase": {"type": "hg", "g": 0.4},
            },
        },
        "sun": {"type": "directional", "direction": [1, -1, -0.3], "irradiance": {"type": "rgb", "value": [6, 5, 4]}},
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [0.12, 0.2, 0.35]}},
    }


def main():
    loaded = mi.load_dict(scene())
    images = []
    for integrator, spp in (
        ({"type": "photonvdb", "photons": 1_000_000}, 16),
        ({"type": "volpath", "max_depth": -1}, 128),
    ):
        start = time.perf_counter()
        images.append(np.array(mi.render(loaded, integrator=mi.load_dict(integrator), spp=spp)))
        seconds = time.perf_counter() - start
        print(f"{integrator['type']}: {seconds:.1f} s, mean {images[-1].mean():.5f}")
    path = sys.argv[1] if len(sys.argv) > 1 else "smoke.png"
    mi.util.write_bitmap(path, np.concatenate(images, axis=1))


if __name__ == "__main__":
    main()
