"""Draws the bias of k-nearest estimates against k: exact lines, measured points.

    python plugins/python/examples/bias_curve.py bias_curve.png
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import photonvdb

MODELS = {"3d-random": "random photons", "3d-jittered": "one photon a cell"}


def main(path: str) -> None:
    table = photonvdb.bias(MODELS, k=[2, 3, 5, 8, 12, 20, 32, 50, 80, 120, 200], trials=20_000, divisors="k", seed=1)
    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    for model, label in MODELS.items():
        rows = table["model"] == model
        k, measured, error = (table[name][rows] for name in ["k", "measured_bias", "std_error"])
        points = axes.errorbar(k, measured, error, fmt="o", markersize=4, capsize=2, label=label)
        if (table["exact_bias"][rows] > 0).any():
            axes.plot(k, table["exact_bias"][rows], color=points[0].get_color(), label=f"{label}, exact: 1 / (k - 1)")
    axes.set(xscale="log", yscale="log", xlabel="k", ylabel="bias of the estimate, relative")
    axes.set_title("Power density from the k nearest photons is too high")
    axes.legend()
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "bias_curve.png")
