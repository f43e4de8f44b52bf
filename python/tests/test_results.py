"""What a run gives: tables, arrays, measures, drawings, the page."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import pluvia


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
    assert len(both) == 2 and both["void_ratio"].nunique() == 1


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
    assert not grains.columns.str.endswith(("_x", "_y")).all() and grains["grain"].is_unique
    assert grains["mass_g"].sum() == pytest.approx(poured["grains.mass_g"])


def test_hulls_are_the_grains_where_they_are(poured: pluvia.Run) -> None:
    specimen = poured.specimen
    for n in range(5):
        local, there = specimen.local_hulls[n], specimen.hulls[n]
        expected = rotated(local, specimen.orientations[n]) + specimen.positions[n]
        assert np.allclose(there, expected, rtol=0, atol=1e-12), "law: pose of the corners"
        got = volume(local, specimen.faces(n)) * 1e9
        assert got == pytest.approx(poured.grains["volume_mm3"][n], rel=1e-9), "law: faces close the volume"
    with pytest.raises(ValueError, match="no grain 9999"):
        specimen.faces(9999)


def test_stages_have_specimens_of_their_own(vibrated: pluvia.Run) -> None:
    pour, last = vibrated.at("pour"), vibrated.at(3)
    assert pour.stage == "pour" and last.stage == "vibrate" and pour.time_s < last.time_s < vibrated.specimen.time_s
    assert not np.allclose(pour.positions, last.positions)
    assert last.mean_surface_mm == pytest.approx(vibrated["standing_height_mm.mean_surface"], abs=1e-9)
    with pytest.raises(ValueError, match="fill_funnel"):
        vibrated.at("melt")


def test_the_void_profile_adds_up(poured: pluvia.Run) -> None:
    specimen = poured.specimen
    inside = specimen.grains[specimen.present]
    top = float(max(hull[:, 2].max() for hull in specimen.hulls)) * 1000.0
    profile = poured.void_profile(7, top_mm=top + 1e-6)
    assert len(profile) == 7 and profile["high_mm"].iloc[-1] == pytest.approx(top, abs=1e-3)
    # Grains reach into floor and each other by little, and below the floor nothing counts.
    assert profile["solids_cm3"].sum() == pytest.approx(inside["volume_mm3"].sum() / 1000.0, rel=2e-3)
    layer_cm3 = specimen.area_m2 * (profile["high_mm"] - profile["low_mm"]) * 1000.0
    assert np.allclose(profile["void_ratio"], layer_cm3 / profile["solids_cm3"] - 1.0)
    assert np.allclose(profile["porosity"], profile["void_ratio"] / (1.0 + profile["void_ratio"]))
    for bad in ({"layers": 0}, {"top_mm": -1.0}, {"top_mm": float("nan")}):
        with pytest.raises(ValueError, match=next(iter(bad))):
            poured.void_profile(**bad)


def contacts(*rows: tuple[str, str, tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]) -> pd.DataFrame:
    """A table of contacts: the two, point in mm, normal, force in N."""
    names = ["x_mm", "y_mm", "z_mm", "normal_x", "normal_y", "normal_z", "force_x_n", "force_y_n", "force_z_n"]
    table = [dict(zip(names, [*at, *n, *f]), first=a, second=b) for a, b, at, n, f in rows]
    return pd.DataFrame(table, columns=["first", "second", *names])


def test_stress_of_two_grains_pressed_together() -> None:
    # Two spheres of 20 mm one above the other, pressed by 3 N between floor and plate.
    up, force = (0.0, 0.0, 1.0), (0.0, 0.0, 3.0)
    table = contacts(
        ("grain_00001", "grain_00000", (0, 0, 20), up, force),
        ("grain_00000", "floor", (0, 0, 0), up, force),
        ("top_plate", "grain_00001", (0, 0, 40), up, force),
    )
    positions = np.array([[0, 0, 0.01], [0, 0, 0.03]])
    got = pluvia.stress(table, positions, volume_m3=0.02 * 0.02 * 0.04)
    expected = np.zeros((3, 3))
    expected[2, 2] = 3.0 / (0.02 * 0.02)
    assert np.allclose(got, expected, rtol=1e-12), "law: force over area, compression positive"
    half = pluvia.stress(table, positions, volume_m3=0.02 * 0.02 * 0.02, low_mm=10, high_mm=30)
    assert half[2, 2] == pytest.approx(3.0 / (0.02 * 0.02)), "law: the middle contact alone bears its layer"
    assert not np.allclose(pluvia.stress(table.assign(force_z_n=-3.0), positions, volume_m3=1.6e-5), expected)


def test_fabric_of_known_normals() -> None:
    up, side, none = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    table = contacts(
        ("grain_00001", "grain_00000", none, up, none),
        ("grain_00002", "grain_00000", none, (0.0, 0.0, -1.0), none),
        ("grain_00002", "grain_00001", none, up, none),
        ("grain_00003", "grain_00000", none, side, none),
        ("grain_00000", "floor", none, side, none),
    )
    assert np.allclose(pluvia.fabric(table), np.diag([0.25, 0.0, 0.75])), "law: mean n n, walls do not count"
    assert np.isnan(pluvia.fabric(table.iloc[:0])).all()


def test_forces_of_pairs_are_distributed() -> None:
    up, at = (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)
    table = contacts(
        ("grain_00001", "grain_00000", at, up, (5.0, 0.0, 1.0)),
        ("grain_00001", "grain_00000", at, up, (0.0, 0.0, 2.0)),
        ("grain_00002", "grain_00000", at, up, (0.0, 0.0, 1.0)),
        ("grain_00002", "floor", at, up, (0.0, 0.0, 100.0)),
    )
    got = pluvia.force_distribution(table, bins=3)
    assert got.attrs["mean_normal_force_n"] == pytest.approx(2.0), "law: points of a pair are summed, walls left out"
    assert got["pairs"].tolist() == [0, 1, 1]
    assert (got["probability_density"] * (got["high"] - got["low"])).sum() == pytest.approx(1.0)
    assert len(pluvia.force_distribution(table.iloc[:0])) == 0
    with pytest.raises(ValueError, match="bins"):
        pluvia.force_distribution(table, bins=0)


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
    volume_m3 = poured.specimen.area_m2 * poured.specimen.mean_surface_mm / 1000.0
    stress = poured.stress()
    assert stress[2, 2] * volume_m3 == pytest.approx(held, rel=0.1)
    assert np.trace(poured.fabric()) == pytest.approx(1.0)
    # Three quarters of the layer is a layer, too; a layer upside down is none.
    assert poured.stress(low_mm=0.0, high_mm=poured.specimen.mean_surface_mm * 0.75)[2, 2] > 0.0
    with pytest.raises(ValueError, match="no volume"):
        poured.stress(low_mm=10.0, high_mm=5.0)
    assert poured.force_distribution(bins=8)["pairs"].sum() > 10


@pytest.mark.parametrize("what", ["overview", "heights", "settlement", "energy", "void_profile", "forces", "normals"])
def test_everything_can_be_drawn(vibrated: pluvia.Run, what: str, tmp_path: Path) -> None:
    figure = vibrated.plot(what)
    assert all(ax.get_xlabel() and ax.get_ylabel() for ax in figure.axes), "law: axes are named"
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
    plt.close("all")


def test_the_page_holds_the_run(poured: pluvia.Run, tmp_path: Path) -> None:
    view = poured.view()
    assert view.html.lstrip().lower().startswith("<!doctype html")
    inline = view._repr_html_()
    assert inline.startswith("<iframe srcdoc=") and inline.count('"') == 8, "law: nothing of the page ends the attribute"
    saved = view.save(tmp_path / "page.html")
    assert saved.read_text(encoding="utf-8") == view.html
