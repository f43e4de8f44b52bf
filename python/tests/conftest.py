"""Scenarios of a few grains, and runs of them that tests share."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import matplotlib
import pytest

matplotlib.use("Agg")

import pluvia

ROOT = Path(__file__).parents[2]


def layer(mass_g: float = 40.0) -> dict[str, Any]:
    """Grains poured through a wide funnel: a layer whose height depends on how many there are."""
    return {
        "name": "layer",
        "grains": {
            "total_mass_g": mass_g,
            "density_kg_per_m3": 2673.9,
            "sieve_table": [{"passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100}],
        },
        "apparatus": {
            "cylinder": {"inner_diameter_mm": 75, "height_mm": 120},
            "funnel": {"opening_diameter_mm": 72, "top_diameter_mm": 140},
        },
        "engine": {"rate_hz": 240},
        "stages": [
            {"stage": "fill_funnel", "time_limit_s": 1},
            {"stage": "pour", "falling_height_mm": 0, "time_limit_s": 1.5},
        ],
        "rest_test_s": 0.4,
    }


def shaken() -> dict[str, Any]:
    """A layer under a plate, shaken for two cycles."""
    scenario = layer(60.0)
    scenario["name"] = "shaken"
    scenario["apparatus"]["top_plate"] = {"diameter_mm": 72, "mass_g": 40}
    scenario["stages"] += [
        {"stage": "place_top_plate"},
        {"stage": "vibrate", "frequency_hz": 4, "amplitude_mm": 5, "duration_s": 0.5},
    ]
    return scenario


def box(floor_mm: float = 0.0) -> dict[str, Any]:
    """A laboratory: grains that rain into a box on a floor of a height."""
    return {
        "name": "box",
        "grains": layer(100.0)["grains"],
        "pieces": [{"name": "box", "shape": {"box": {"inner_mm": [70, 70, 80]}}, "at_mm": [0, 0, floor_mm]}],
        "engine": {"rate_hz": 240},
        "stages": [
            {"stage": "deposit", "at_mm": [0, 0, floor_mm + 60], "area_mm": [56, 56], "rate_g_per_s": 300},
        ],
        "rest_test_s": 0.4,
    }


def pile() -> dict[str, Any]:
    """Grains that fall one by one on a base."""
    stage = {"stage": "slow_pluviation", "feed_rate_grains_per_s": 20, "drop_height_mm": 5, "base_diameter_mm": 60}
    return {
        "name": "pile",
        "grains": layer(25.0)["grains"],
        "engine": {"rate_hz": 240},
        "stages": [{**stage, "time_limit_s": 1.5}],
        "rest_test_s": 0.4,
    }


@pytest.fixture(scope="session", autouse=True)
def installed() -> None:
    """From an installed wheel nothing of the sources is imported."""
    if os.environ.get("PLUVIA_INSTALLED"):
        assert "site-packages" in pluvia.__file__, f"the package tested is {pluvia.__file__}"


@pytest.fixture(scope="session")
def poured(tmp_path_factory: pytest.TempPathFactory) -> pluvia.Run:
    """A run of a layer."""
    return pluvia.run(layer(100.0), tmp_path_factory.mktemp("poured") / "run", progress=False)


@pytest.fixture(scope="session")
def vibrated(tmp_path_factory: pytest.TempPathFactory) -> pluvia.Run:
    """A run that was shaken."""
    return pluvia.run(shaken(), tmp_path_factory.mktemp("vibrated") / "run", progress=False)


@pytest.fixture(scope="session")
def boxed(tmp_path_factory: pytest.TempPathFactory) -> pluvia.Run:
    """A run of a laboratory with a region."""
    scenario = box()
    scenario["measures"] = {"regions": [{"name": "core", "low_mm": [-20, -20, 2], "high_mm": [20, 20, 12]}]}
    return pluvia.run(scenario, tmp_path_factory.mktemp("boxed") / "run", progress=False)


@pytest.fixture(scope="session")
def piled(tmp_path_factory: pytest.TempPathFactory) -> pluvia.Run:
    """A run of a pile."""
    return pluvia.run(pile(), tmp_path_factory.mktemp("piled") / "run", progress=False)


@pytest.fixture
def in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory of its own."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


