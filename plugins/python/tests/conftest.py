"""Scenes that all tests share."""

import os
import pathlib
import shutil

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]


@pytest.fixture
def fog():
    """A small scene: a point light beside a cube of fog, as a dict."""
    return {
        "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0], "resolution": [12, 8]},
        "medium": {
            "kind": "homogeneous",
            "bounds": {"min": [-1, -1, -1], "max": [1, 1, 1]},
            "sigma_t": 1.0,
            "albedo": 0.9,
        },
        "light": [{"kind": "point", "position": [0, 3, 0], "intensity": 10.0}],
        "photons": {"count": 5000},
    }


@pytest.fixture
def furnace():
    """Light of 1 W/(m^2 sr) all around a medium that absorbs nothing: the fluence is 4 pi everywhere."""
    return {
        "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0], "vertical_fov": 10, "resolution": [4, 4]},
        "medium": {
            "kind": "homogeneous",
            "bounds": {"min": [-1, -1, -1], "max": [1, 1, 1]},
            "sigma_t": 1.0,
            "albedo": 1.0,
        },
        "light": [{"kind": "environment", "radiance": 1.0}],
        "photons": {"count": 200_000},
    }


@pytest.fixture
def root():
    """The project's folder."""
    return ROOT


@pytest.fixture
def cli():
    """The command line of the same version."""
    path = os.environ.get("PHOTONVDB_CLI") or shutil.which("photonvdb")
    if path is None:
        pytest.skip("no photonvdb command: set PHOTONVDB_CLI")
    return path
