"""Sweeps and calibrations on a few grains."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import layer

import pluvia


def test_a_sweep_has_its_table(in_folder: Path) -> None:
    asked = {"over": {"grains.total_mass_g": [15, 25]}, "progress": False}
    sweep = pluvia.sweep(layer(), "out", configurations=2, **asked)
    table = sweep.table.sort_values(["grains.total_mass_g", "configuration"], ignore_index=True)
    assert len(table) == 4 and table["failure"].isna().all()
    assert table["grains.total_mass_g"].tolist() == [15, 15, 25, 25]
    heights = table.groupby("grains.total_mass_g")["standing_height_mm.mean_surface"].mean()
    assert heights[25] > heights[15]
    points = sweep.points[sweep.points["outcome"] == "standing_height_mm.mean_surface"]
    assert points["mean"].tolist() == pytest.approx(heights.tolist())
    assert (points["t_low"] < points["mean"]).all() and (points["mean"] < points["t_high"]).all()
    slope = sweep.effects.set_index("outcome").loc["poured_height_mm.mean_surface", "slope"]
    assert slope == pytest.approx((heights[25] - heights[15]) / 10.0)
    run = sweep.run(table["run"][0])
    assert run["standing_height_mm.mean_surface"] == table["standing_height_mm.mean_surface"][0]
    stored = {path: path.stat().st_mtime_ns for path in Path("out/stages").glob("*/stage.json")}
    again = pluvia.sweep(layer(), "out", configurations=2, **asked)
    assert again.table.equals(sweep.table), "law: the same table"
    found = {path: path.stat().st_mtime_ns for path in Path("out/stages").glob("*/stage.json")}
    assert stored and found == stored, f"law: finished stages are not run again, got {found}, had {stored}"
    assert pluvia.load_sweep("out").record == again.record and sweep.report.is_file()


def test_points_are_drawn_from_ranges(in_folder: Path) -> None:
    sweep = pluvia.sweep(layer(15.0), "out", ranges={"contact.restitution": (0.1, 0.5)}, samples=2, progress=False)
    drawn = sweep.table["contact.restitution"]
    assert len(drawn) == 2 and drawn.between(0.1, 0.5).all() and drawn.nunique() == 2


def test_a_sweep_of_nothing_is_refused(in_folder: Path) -> None:
    with pytest.raises(pluvia.ScenarioError, match="--over"):
        pluvia.sweep(layer(), "out", progress=False)
    with pytest.raises(pluvia.ScenarioError, match="friktion"):
        pluvia.sweep(layer(), "out", over={"contact.friktion": [1, 2]}, progress=False)


def test_a_mass_is_found_for_a_height(in_folder: Path) -> None:
    asked = {
        "target": {"standing_height_mm.mean_surface": 9},
        "unknown": "grains.total_mass_g",
        "between": (20, 90),
        "realisations": 3,
        "tolerance": 1.0,
        "progress": False,
    }
    found = pluvia.calibrate(layer(), "out", **asked)
    assert found.found and found.ending == "found", found.statement
    assert found.value is not None and 20 < found.value < 90
    assert found.interval_95 is not None and found.interval_95[0] < found.value < found.interval_95[1]
    assert len(found.table) == found.values["runs"].sum() and {"value", "mean"} <= set(found.values)
    assert str(found.statement) in repr(found)
    assert pluvia.load_calibration("out").record == found.record


def test_a_height_that_no_mass_gives_is_no_exception(in_folder: Path) -> None:
    found = pluvia.calibrate(
        layer(),
        "out",
        target={"standing_height_mm.mean_surface": 90},
        unknown="grains.total_mass_g",
        between=(15, 30),
        realisations=2,
        progress=False,
    )
    assert not found.found and found.ending == "out_of_reach" and found.value is None and found.interval_95 is None


def test_a_target_that_no_summary_has_is_refused(in_folder: Path) -> None:
    with pytest.raises(pluvia.Error, match="heigth"):
        pluvia.calibrate(layer(), "out", target={"heigth": 1}, unknown="seed", between=(1, 2), progress=False)


def test_an_old_name_is_refused_with_the_new_one(in_folder: Path) -> None:
    with pytest.raises(TypeError, match="realisations"):
        pluvia.calibrate(layer(), "out", angle_of_repose_degrees=38, replicates=3, progress=False)


def test_a_result_that_no_run_measures_is_said(in_folder: Path) -> None:
    with pytest.raises(pluvia.ScenarioError, match="does not measure it"):
        pluvia.calibrate(
            layer(15.0),
            "out",
            target={"angle_of_repose.degrees": 30},
            unknown="contact.grain_grain_friction",
            between=(0.2, 0.8),
            realisations=2,
            progress=False,
        )
