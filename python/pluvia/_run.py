"""Runs: simulated, or opened from their folders."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import pandas as pd

from . import _table
from ._command import Shown, command
from ._errors import FileError, NotValidWarning
from ._scenario import Scenario, as_file, options
from ._specimen import Array, Specimen
from ._view import View

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def run(
    scenario: Scenario,
    out: str | os.PathLike[str],
    *,
    changes: Mapping[str, Any] | None = None,
    seed: int | None = None,
    backend: str | None = None,
    jobs: int | None = None,
    force: bool = False,
    progress: Shown = True,
) -> Run:
    """Simulates a scenario into the folder `out`, and opens it.

    `scenario` is a file or a dict. `changes` are laid over it, field by field:
    `{"engine.rate_hz": 960, "stages.1.falling_height_mm": 50}`. `seed` and `backend` (`bullet` or `rapier`) take the
    place of the scenario's. `jobs` is the number of cores, all unless given; results do not depend on it.

    Ctrl-C, or the notebook's interrupt, stops at a point from which the same call resumes. A folder that holds the
    results of another scenario is refused, unless `force` replaces them.

    Other threads of the program continue meanwhile. Raises `ScenarioError`, `SimulationError` or `FileError`; warns with
    `NotValidWarning` of a run whose numbers do not count.
    """
    words = [f"--out={os.fspath(out)}", *options(changes, seed, backend, jobs)]
    words += ["--force"] if force else []
    with as_file(scenario) as file:
        command(["run", *words, "--", file], progress)
    done = load(out)
    if why := done.record.get("left_out_of_means"):
        head = "is left out of means" if done.record.get("valid") else "is not valid, no result to quote"
        warnings.warn(f"{done.folder} {head}: {'; '.join(why)}", NotValidWarning, stacklevel=2)
    return done


def load(folder: str | os.PathLike[str]) -> Run:
    """Opens the folder of a finished run, as `run` and the commands of `pluvia` leave it."""
    return Run(folder)


class Run:
    """A finished run. Its measures are those of the specimen at rest: at the end of the rest test or, without one, of
    the last stage. `at` gives the specimen at the end of another stage."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        self.record: dict[str, Any] = self._json("summary.json")
        """`summary.json`, as it is nested there."""

    def _json(self, name: str) -> dict[str, Any]:
        path = self.folder / name
        try:
            return _table.fields(path)
        except FileError:
            raise
        except OSError as error:
            others = [f"pluvia.load_{kind}" for kind, file in (("sweep", "sweep.json"), ("calibration", "calibrate.json"))
                      if (self.folder / file).is_file()]
            hint = f"; {others[0]} opens it" if others else ""
            raise FileError(f"{self.folder} is not the folder of a finished run{hint}: {error}") from None

    def __repr__(self) -> str:
        grains = self.record.get("grains", {}).get("count")
        valid = "" if self.valid else ", NOT VALID"
        return f"<pluvia.Run {self.record.get('scenario')} in {self.folder}, {grains} grains{valid}>"

    def __getitem__(self, field: str) -> Any:
        """A field of the summary by its path, such as `run["standing_height_mm.mean_surface"]`; None where it is null."""
        value: Any = self.record
        for step in field.split("."):
            if isinstance(value, list) and step.isdigit() and int(step) < len(value):
                value = value[int(step)]
            elif isinstance(value, Mapping) and step in value:
                value = value[step]
            else:
                raise KeyError(f"{self.folder / 'summary.json'} has no field `{field}`")
        return value

    @property
    def valid(self) -> bool:
        """Whether the accuracy standard is met, no run-time check found anything, and grains had settled where heights are
        read."""
        return bool(self.record.get("valid"))

    @cached_property
    def scenario(self) -> dict[str, Any]:
        """The scenario with every default filled in."""
        scenario = self._json("manifest.json").get("scenario")
        if not isinstance(scenario, dict):
            raise FileError(f"{self.folder / 'manifest.json'} has no `scenario`")
        return scenario

    @property
    def stages(self) -> list[str]:
        """Names of the stages, in order."""
        return [stage["stage"] for stage in self.scenario["stages"]]

    @cached_property
    def summary(self) -> pd.DataFrame:
        """The summary as one row, with a column per field, named by its path (`standing_height_mm.mean_surface`):
        `pandas.concat` joins the rows of many runs. What is missing is NaN. Lists stay in `record`."""
        row = pd.json_normalize(self.record)
        values = {name: row[name].iloc[0] for name in row.columns}
        flat = {name: value for name, value in values.items() if not isinstance(value, list)}
        return _table.of([flat]).set_axis([self.folder.name])

    @cached_property
    def series(self) -> pd.DataFrame:
        """The course of the run, `series.csv`: one row per sample (every 0.08 s, or
        `sample_interval_s`), with `time_s`, `mean_surface_mm`, `settlement_mm`, `kinetic_energy_j`
        and more."""
        return _table.read_file(self.folder / "series.csv")

    def at(self, stage: str | int | None = None) -> Specimen:
        """The specimen at the end of a stage: its number from 0, its name if no other stage has it, or `"rest_test"`."""
        return Specimen(self.folder, stage)

    @cached_property
    def specimen(self) -> Specimen:
        """The specimen at rest."""
        return self.at()

    @property
    def grains(self) -> pd.DataFrame:
        """One row per grain; see `Specimen.grains`."""
        return self.specimen.grains

    @property
    def contacts(self) -> pd.DataFrame:
        """One row per loaded contact point; see `Specimen.contacts`."""
        return self.specimen.contacts

    @property
    def positions(self) -> Array:
        """Centroids in m, of the shape (grains, 3)."""
        return self.specimen.positions

    @property
    def orientations(self) -> Array:
        """Unit quaternions x, y, z, w, of the shape (grains, 4)."""
        return self.specimen.orientations

    @property
    def hulls(self) -> list[Array]:
        """Corners of each grain where it is, in m."""
        return self.specimen.hulls

    def void_profile(
        self,
        count: int = 10,
        *,
        by: Literal["height", "radius"] = "height",
        low_mm: float = 0.0,
        high_mm: float | None = None,
    ) -> pd.DataFrame:
        """Void ratio of layers of the cylinder from the floor up, or of rings from its axis; see
        `Specimen.void_profile`."""
        return self.specimen.void_profile(count, by=by, low_mm=low_mm, high_mm=high_mm)

    def stress(self, *, low_mm: float = 0.0, high_mm: float | None = None) -> Array:
        """Mean stress tensor in Pa in the cylinder, compression positive; see `Specimen.stress`."""
        return self.specimen.stress(low_mm=low_mm, high_mm=high_mm)

    def fabric(self, *, low_mm: float | None = None, high_mm: float | None = None) -> Array:
        """Fabric tensor of the contacts between grains; see `Specimen.fabric`."""
        return self.specimen.fabric(low_mm=low_mm, high_mm=high_mm)

    def force_distribution(self) -> pd.DataFrame:
        """Distribution of the normal forces between grains; see `Specimen.force_distribution`."""
        return self.specimen.force_distribution()

    def plot(self, what: str = "overview", *, ax: Axes | None = None) -> Figure:
        """Draws the run with matplotlib: `overview`, or one of `heights`, `settlement`, `energy`, `void_profile`,
        `forces`, `normals`, into `ax` if given. Without a cylinder the overview shows `normals` in place of the void
        profile."""
        from . import _plot

        return _plot.plot(self, what, ax)

    def view(self) -> View:
        """The run as a page that plays it in three dimensions: shown inline as the last value of a notebook's cell;
        `.open()` opens a browser, `.save(file)` keeps it."""
        return View(self.folder)
