"""Drawings of a run with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ._run import Run


def plot(run: Run, what: str, ax: Axes | None) -> Figure:
    """Draws one thing into `ax`, or the overview into a figure of its own."""
    if what == "overview":
        if ax is not None:
            raise ValueError("an overview has axes of its own: leave `ax` out")
        return _overview(run)
    if what not in _DRAWN:
        raise ValueError(f"`{what}` cannot be drawn; there are overview, {', '.join(_DRAWN)}")
    if what == "void_profile":
        # A drawing that is refused leaves no empty figure.
        run.specimen._need_cylinder()
    if ax is None:
        ax = _figure(layout="constrained").add_subplot()
    _DRAWN[what](run, ax)
    # Axes may be of a part of a figure; `get_figure(root=True)` is new in matplotlib 3.10.
    figure: Figure = ax.figure.figure
    return figure


def _figure(**options: Any) -> Figure:
    """A figure that a notebook shows once, as the value of its cell, and a script by pyplot's `show`."""
    import matplotlib.pyplot as plt

    figure = plt.figure(**options)
    if plt.get_backend().lower().endswith("inline"):
        plt.close(figure)
    return figure


def _overview(run: Run) -> Figure:
    # Without a plate the surface settles.
    shaken = run.series[["settlement_mm", "surface_settlement_mm"]].notna().any(axis=None)
    figure = _figure(figsize=(9.0, 6.0), layout="constrained")
    axes = figure.subplots(2, 2)
    # Only the cylinder is a container that layers are parts of.
    inside = "void_profile" if run.specimen.has_cylinder else "normals"
    drawn = ["heights", "settlement" if shaken else "energy", inside, "forces"]
    for name, ax in zip(drawn, axes.flat):
        _DRAWN[name](run, ax)
    void_ratio = run.record.get("void_ratio")
    text = "" if void_ratio is None else f", void ratio {void_ratio:.3f}"
    valid = "" if run.valid else ", NOT VALID"
    figure.suptitle(f"{run.record.get('scenario')}: {run.record['grains']['count']} grains{text}{valid}")
    return figure


def _stages(run: Run, ax: Axes) -> None:
    """Lines where stages begin, with their names."""
    starts = run.series.groupby("stage")["time_s"].min()
    for number, start in starts.items():
        ax.axvline(start, color="0.85", linewidth=0.8, zorder=0)
        name = run.stages[int(str(number))].replace("_", " ")
        ax.annotate(
            name,
            (start, 0.98),
            xycoords=ax.get_xaxis_transform(),
            xytext=(2, 0),
            textcoords="offset points",
            rotation=90,
            va="top",
            ha="left",
            fontsize=7,
            color="0.4",
        )
    ax.set_xlabel("Time (s)")


def _heights(run: Run, ax: Axes) -> None:
    series = run.series
    # A laboratory of pieces has no surface, but grains.
    has_surface = series["mean_surface_mm"].notna().any()
    column, label = ("mean_surface_mm", "mean surface") if has_surface else ("mean_grain_height_mm", "mean grain")
    ax.plot(series["time_s"], series[column], label=label)
    if series["plate_height_mm"].notna().any():
        ax.plot(series["time_s"], series["plate_height_mm"], label="top plate")
    _stages(run, ax)
    ax.set_ylabel("Height (mm)")
    ax.legend(loc="center right")


def _settlement(run: Run, ax: Axes) -> None:
    shaken = run.series[run.series["settlement_mm"].notna() | run.series["surface_settlement_mm"].notna()]
    for column, label in (("settlement_mm", "top plate"), ("surface_settlement_mm", "mean surface")):
        # Without a plate there is nothing to be named.
        if shaken[column].notna().any():
            ax.plot(shaken["time_s"], shaken[column], label=label)
    ax.set_xlabel("Time (s)")
    ax.set_ylabel("Settlement (mm)")
    if len(shaken):
        ax.invert_yaxis()
        ax.legend()


def _energy(run: Run, ax: Axes) -> None:
    energy = run.series["kinetic_energy_j"].where(lambda e: e > 0.0)
    ax.semilogy(run.series["time_s"], energy)
    _stages(run, ax)
    ax.set_ylabel("Kinetic energy (J)")


def _void_profile(run: Run, ax: Axes) -> None:
    profile = run.void_profile(12)
    edges = np.append(profile["from_mm"], profile["to_mm"].iloc[-1])
    ax.stairs(profile["void_ratio"], edges, orientation="horizontal", baseline=None)
    ax.set_xlabel("Void ratio")
    ax.set_ylabel("Height above the floor (mm)")


def _forces(run: Run, ax: Axes) -> None:
    forces = run.force_distribution()
    seen = forces[(forces["probability_density"] > 0.0)]
    ax.semilogy((seen["low"] + seen["high"]) / 2.0, seen["probability_density"], "o", markersize=4)
    ax.set_xlabel("Normal force between grains over its mean")
    ax.set_ylabel("Probability density")
    mean = forces.attrs["mean_normal_force_n"]
    if np.isfinite(mean):
        ax.set_title(f"{len(run.specimen.loaded)} contacts, mean {mean:.3g} N", fontsize="medium")


def _normals(run: Run, ax: Axes) -> None:
    """Inclinations of the contact normals, beside those of no preferred direction."""
    upward = run.specimen.loaded["normal_z"].abs().clip(upper=1.0)
    if len(upward):
        ax.hist(np.degrees(np.arccos(upward)), bins=18, range=(0.0, 90.0), density=True, label="contacts")
    angle = np.linspace(0.0, 90.0, 91)
    ax.plot(angle, np.sin(np.radians(angle)) * np.pi / 180.0, color="black", label="no preferred direction")
    ax.set_xlabel("Inclination of the normal from the vertical (degrees)")
    ax.set_ylabel("Probability density (1/degree)")
    ax.legend()


_DRAWN = {
    "heights": _heights,
    "settlement": _settlement,
    "energy": _energy,
    "void_profile": _void_profile,
    "forces": _forces,
    "normals": _normals,
}
