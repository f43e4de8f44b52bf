"""What a run gives: tables, arrays, measures, drawings, the page."""

from __future__ import annotations

import io
import json
import warnings
from pathlib import Path

import matplotlib.figure
import numpy as np
import pandas as pd
import pytest
from conftest import box

import pluvia
from pluvia import _table


def rotated(points: np.ndarray, quaternion: np.ndarray) -> np.ndarray:
    """Points turned by a unit quaternion x, y, z, w."""
    q, w = quaternion[:3], quaternion[3]
    return points + 2.0 * np.cross(q, np.cross(q, points) + w * points)


def volume(corners: np.ndarray, faces: list[list[int]]) -> float:
    """Volume within faces, by the divergence theorem."""
    fans = [(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)]
    return sum(np.dot(corners[a], np.cross(corners[b], corners[c])) for a, b, c in fans) / 6.0


def test_the_summary_is_that_of_the_file(poured: pluvia.Run) -> None:
    content = json.loads((poured.folder / "summary.json").read_text())
    assert poured.record == content
    assert poured["standing_height_mm.mean_surface"] == content["standing_height_mm"]["mean_surface"]
    fraction = content["sieve_analysis"]["fractions"][0]
    name = next(iter(fraction))
    assert poured[f"sieve_analysis.fractions.0.{name}"] == fraction[name], "law: elements of lists by their number"
    with pytest.raises(KeyError, match="no field `void`"):
        poured["void"]
    row = poured.summary
    assert isinstance(row, pd.DataFrame) and len(row) == 1
    assert row["standing_height_mm.mean_surface"].iloc[0] == content["standing_height_mm"]["mean_surface"]
    both = pd.concat([row, row])
    assert len(both) == 2 and both["standing_height_mm.mean_surface"].nunique() == 1


def test_what_is_missing_is_nan_in_every_frame(poured: pluvia.Run, vibrated: pluvia.Run) -> None:
    """Law: what is null in JSON or empty in CSV is NaN in frames, and None in nested records; a text is a text."""
    assert poured.record["settlement_mm"] is None and poured["settlement_mm"] is None, "law: nothing was shaken"
    assert np.isnan(poured.summary["settlement_mm"].iloc[0]), "law: no settlement is NaN"
    assert poured.summary["settlement_mm"].dtype == float, "law: as in columns that have numbers"
    assert not any(value is None for value in poured.summary.iloc[0]), f"law: no None, got {poured.summary.iloc[0]}"
    both = pd.concat([poured.summary, vibrated.summary])
    assert both["settlement_mm.final"].dtype == float and both["settlement_mm.final"].isna().tolist() == [True, False]
    assert poured.series["settlement_mm"].dtype == float and poured.series["settlement_mm"].isna().all()
    table = _table.read(io.BytesIO(b"piece,force_n,void_ratio\nNA,1.5,\nNone,,0.5\nnull,NaN,0.7\n"))
    assert table["piece"].tolist() == ["NA", "None", "null"], "law: pieces are called as they like"
    assert table["force_n"].isna().tolist() == [False, True, True] and table["void_ratio"].dtype == float
    rows = _table.of([{"t_low": None, "mean": 2.0}, {"t_low": None, "mean": None}])
    assert rows["t_low"].dtype == float and rows["t_low"].isna().all(), "law: also where all are missing"


def test_the_series_has_units_in_its_names(vibrated: pluvia.Run) -> None:
    series = vibrated.series
    for column in ("time_s", "stage", "mean_surface_mm", "plate_height_mm", "settlement_mm", "kinetic_energy_j"):
        assert column in series
    assert series["time_s"].is_monotonic_increasing
    assert vibrated.stages == ["fill_funnel", "pour", "place_top_plate", "vibrate"]


def test_grains_contacts_and_arrays_are_of_one_moment(poured: pluvia.Run) -> None:
    grains, count = poured.grains, poured["grains.count"]
    assert len(grains) == count == len(poured.positions) == len(poured.orientations) == len(poured.hulls)
    assert np.allclose(grains[["x_mm", "y_mm", "z_mm"]], poured.positions * 1000.0, rtol=0, atol=1e-9)
    assert np.allclose(grains[["rotation_x", "rotation_y", "rotation_z", "rotation_w"]], poured.orientations, atol=1e-12)
    assert np.allclose(np.linalg.norm(poured.orientations, axis=1), 1.0, atol=1e-9)
    assert {"mass_g", "sieve_size_mm", "elongation", "fate", "velocity_z_mm_per_s"} <= set(grains)
    # What two merged tables both have is called so by pandas.
    doubled = [name for name in grains if name.endswith(("_x", "_y")) and not name.startswith("rotation_")]
    assert doubled == [] and grains["grain"].is_unique, f"law: each column once, got {doubled}"
    assert grains["mass_g"].sum() == pytest.approx(poured["grains.mass_g"])


def test_hulls_are_the_grains_where_they_are(poured: pluvia.Run) -> None:
    specimen = poured.specimen
    for n in range(5):
        local, there = specimen.local_hulls[n], specimen.hulls[n]
        expected = rotated(local, specimen.orientations[n]) + specimen.positions[n]
        assert np.allclose(there, expected, rtol=0, atol=1e-12), "law: pose of the corners"
        got = volume(local, specimen.faces(n)) * 1e9
        assert got == pytest.approx(poured.grains["volume_mm3"][n], rel=1e-9), "law: faces close the volume"
    for n in (9999, -1):
        with pytest.raises(ValueError, match=f"grain.* {n}"):
            specimen.faces(n)


def test_stages_have_specimens_of_their_own(vibrated: pluvia.Run) -> None:
    pour, last = vibrated.at("pour"), vibrated.at(3)
    assert pour.stage == "pour" and last.stage == "vibrate" and pour.time_s < last.time_s < vibrated.specimen.time_s
    assert not np.allclose(pour.positions, last.positions)
    assert last.mean_surface_mm == pytest.approx(vibrated["standing_height_mm.mean_surface"], abs=1e-9)
    with pytest.raises(pluvia.ScenarioError, match="fill_funnel"):
        vibrated.at("melt")


def test_the_void_profile_adds_up(poured: pluvia.Run) -> None:
    specimen = poured.specimen
    inside = specimen.grains[specimen.present]
    top = float(max(hull[:, 2].max() for hull in specimen.hulls)) * 1000.0 + 1.0
    # Grains reach into the floor by little.
    profile = poured.void_profile(7, low_mm=-1.0, high_mm=top)
    assert len(profile) == 7 and profile["to_mm"].iloc[-1] == pytest.approx(top)
    assert profile["solids_mm3"].sum() == pytest.approx(inside["volume_mm3"].sum(), rel=1e-9)
    layer_mm3 = specimen.area_m2 * (profile["to_mm"] - profile["from_mm"]) * 1e6
    full = profile["solids_mm3"] > 1.0
    assert np.allclose(profile["void_ratio"][full], (layer_mm3 / profile["solids_mm3"] - 1.0)[full])
    assert np.allclose(profile["porosity"][full], (1.0 - profile["solids_mm3"] / layer_mm3)[full])
    rings = poured.void_profile(5, by="radius", low_mm=-1.0, high_mm=top)
    assert rings["solids_mm3"].sum() == pytest.approx(inside["volume_mm3"].sum(), rel=1e-9)
    assert rings["to_mm"].iloc[-1] == pytest.approx(37.5)
    for bad in ({"count": 0}, {"high_mm": -1.0}, {"low_mm": float("nan")}, {"by": "mass"}):
        with pytest.raises(ValueError, match=next(iter(bad))):
            poured.void_profile(**bad)


def test_only_the_cylinder_has_layers(poured: pluvia.Run, boxed: pluvia.Run, piled: pluvia.Run) -> None:
    """Law: without a cylinder there is no void ratio, neither in the summary nor by layers: the circle around all grains
    of a laboratory is not their container."""
    assert poured.specimen.has_cylinder and poured.at(0).has_cylinder
    for run, instead in ((boxed, "core_void_ratio.*core_stress_zz_kpa"), (piled, "pile has no walls.*fabric")):
        assert run["void_ratio"] is None, f"law: the summary has none, got {run['void_ratio']}"
        assert not run.specimen.has_cylinder
        for measure in (run.void_profile, run.stress, run.specimen.void_profile, run.specimen.stress):
            with pytest.raises(ValueError, match=instead):
                measure(low_mm=0.0, high_mm=10.0)
    named = boxed.series[["core_void_ratio", "core_stress_zz_kpa"]]
    assert named.notna().all(axis=1).iloc[-1], f"law: what the error names is there, got {named.iloc[-1].to_dict()}"
    assert np.trace(boxed.fabric()) == pytest.approx(1.0), "law: no container is needed"


def test_contacts_carry_the_weight(poured: pluvia.Run) -> None:
    """Law: at rest the floor and walls carry the grains, and V σ_zz = Σ m g z − Σ_wall f_z z."""
    table, grains = poured.contacts, poured.grains[poured.specimen.present]
    on_wall = ~table["second"].str.startswith("grain_") | ~table["first"].str.startswith("grain_")
    walls = table[on_wall]
    sign = np.where(walls["first"].str.startswith("grain_"), 1.0, -1.0)
    weight = grains["mass_g"].sum() / 1000.0 * 9.81
    assert (sign * walls["force_z_n"]).sum() == pytest.approx(weight, rel=0.05)
    assert (table["normal_force_n"] >= -1e-9).all() and (table["tangential_force_n"] >= 0.0).all()
    held = (grains["mass_g"] * grains["z_mm"]).sum() * 1e-6 * 9.81 - (sign * walls["force_z_n"] * walls["z_mm"]).sum() / 1000.0
    # Above the mean surface there are grains, too: the layer holds them all.
    top = 200.0
    stress = poured.stress(low_mm=-1.0, high_mm=top)
    assert stress.shape == (3, 3) and np.allclose(stress, stress.T)
    assert stress[2, 2] * poured.specimen.area_m2 * (top + 1.0) / 1000.0 == pytest.approx(held, rel=0.1)
    middle = poured.specimen.mean_surface_mm / 2.0
    assert poured.stress(high_mm=middle)[2, 2] > poured.stress(low_mm=middle)[2, 2] > 0.0, "law: deeper, more"
    with pytest.raises(ValueError, match="low_mm is 10"):
        poured.stress(low_mm=10.0, high_mm=5.0)


def test_fabric_is_the_mean_of_the_normals(poured: pluvia.Run) -> None:
    """Law: the trace is 1, and the vertical part the mean of n_z squared."""
    fabric, loaded = poured.fabric(), poured.specimen.loaded
    assert np.trace(fabric) == pytest.approx(1.0) and np.allclose(fabric, fabric.T)
    assert fabric[2, 2] == pytest.approx((loaded["normal_z"] ** 2).mean())
    assert np.isnan(poured.fabric(low_mm=500.0, high_mm=600.0)).all(), "law: no contacts, no fabric"
    assert poured.record["contacts"]["between_grains"] == len(loaded)


def test_fabric_is_of_all_contacts_wherever_they_lie(in_folder: Path) -> None:
    """Law: without heights every contact counts, also of grains below z = 0, about which no circle is drawn."""
    run = pluvia.run(box(-100.0), "out", progress=False)
    upward = run.specimen.loaded["normal_z"]
    assert len(upward) > 20 and (run.specimen.loaded["z_mm"] < 0.0).all(), "the check has contacts below z = 0"
    expected, got = (upward**2).mean(), run.fabric()[2, 2]
    assert got == pytest.approx(expected, rel=1e-9), f"law: mean of n_z squared, expected {expected}, got {got}"
    with pytest.raises(ValueError, match="name regions in `measures`"):
        run.stress()


def test_forces_are_distributed(poured: pluvia.Run) -> None:
    got, forces = poured.force_distribution(), poured.specimen.loaded["normal_force_n"]
    mean = got.attrs["mean_normal_force_n"]
    assert mean == pytest.approx(forces.mean()) and mean == pytest.approx(poured["contacts.normal_force.mean_n"])
    assert got["share"].sum() == pytest.approx(1.0)
    first = ((forces / mean) < got["high"].iloc[0]).mean()
    assert got["share"].iloc[0] == pytest.approx(first)
    assert got.attrs["max_of_mean"] == pytest.approx(forces.max() / mean)
    assert got["high"].iloc[-1] == np.inf and got["probability_density"].iloc[-1] == 0.0


@pytest.mark.parametrize("what", ["overview", "heights", "settlement", "energy", "void_profile", "forces", "normals"])
def test_everything_can_be_drawn(vibrated: pluvia.Run, what: str, tmp_path: Path) -> None:
    figure = vibrated.plot(what)
    named = [ax.get_xlabel() != "" and ax.get_ylabel() != "" for ax in figure.axes]
    assert named == [True] * (4 if what == "overview" else 1), f"law: axes are there and named, got {named}"
    figure.savefig(tmp_path / "drawn.png")
    assert (tmp_path / "drawn.png").stat().st_size > 5_000


def test_drawings_go_where_they_are_wanted(poured: pluvia.Run) -> None:
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots()
    assert poured.plot("heights", ax=ax) is figure
    with pytest.raises(ValueError, match="void_profile"):
        poured.plot("nothing")
    with pytest.raises(ValueError, match="ax"):
        poured.plot(ax=ax)
    part = plt.figure().subfigures(1, 2)[0].add_subplot()
    assert isinstance(poured.plot("heights", ax=part), matplotlib.figure.Figure), "law: the whole figure"
    plt.close("all")


def test_an_overview_shows_settlement_where_anything_settles(poured: pluvia.Run) -> None:
    def labels(run: pluvia.Run) -> list[str]:
        return [ax.get_ylabel() for ax in run.plot().axes]

    assert "Kinetic energy (J)" in labels(poured)
    shaken = pluvia.load(poured.folder)
    # A specimen without a plate, shaken.
    shaken.series = poured.series.assign(surface_settlement_mm=0.5)
    assert "Settlement (mm)" in labels(shaken)
    (ax,) = shaken.plot("settlement").axes
    named = [text.get_text() for text in ax.get_legend().get_texts()]
    assert named == ["mean surface"], "law: without a plate none is named"


def test_the_overview_of_a_laboratory_has_no_void_profile(poured: pluvia.Run, boxed: pluvia.Run) -> None:
    import matplotlib.pyplot as plt

    def labels(run: pluvia.Run) -> list[str]:
        return [ax.get_xlabel() for ax in run.plot().axes]

    normals = "Inclination of the normal from the vertical (degrees)"
    for run, shown, missing in ((poured, "Void ratio", normals), (boxed, normals, "Void ratio")):
        got = labels(run)
        assert len(got) == 4 and shown in got and missing not in got, f"law: {shown}, got {got}"
    plt.close("all")
    with pytest.raises(ValueError, match="core_void_ratio"):
        boxed.plot("void_profile")
    assert plt.get_fignums() == [], "law: what is refused leaves no empty figure"


def test_without_contacts_only_the_reference_is_drawn(poured: pluvia.Run) -> None:
    # As of rapier, which gives none.
    bare = pluvia.load(poured.folder)
    bare.specimen.loaded = poured.specimen.loaded.iloc[:0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        (ax,) = bare.plot("normals").axes
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["no preferred direction"]


def test_the_page_holds_the_run(poured: pluvia.Run, tmp_path: Path) -> None:
    view = poured.view()
    assert view.html.lstrip().lower().startswith("<!doctype html")
    inline = view._repr_html_()
    assert inline.startswith("<iframe srcdoc=") and inline.count('"') == 8, "law: nothing of the page ends the attribute"
    saved = view.save(tmp_path / "page.html")
    assert saved.read_text(encoding="utf-8") == view.html
