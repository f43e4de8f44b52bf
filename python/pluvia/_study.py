"""Studies of many runs: sweeps and calibrations."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from . import _table
from ._command import Shown, command
from ._errors import FileError
from ._run import Run
from ._scenario import Scenario, as_file, as_value, options


def sweep(
    scenario: Scenario,
    out: str | os.PathLike[str],
    *,
    over: Mapping[str, Sequence[Any]] | None = None,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    samples: int | None = None,
    one_at_a_time: bool = False,
    configurations: int = 1,
    changes: Mapping[str, Any] | None = None,
    seed: int | None = None,
    backend: str | None = None,
    jobs: int | None = None,
    progress: Shown = True,
) -> Sweep:
    """Runs a scenario at many values of its fields into the folder `out`.

    `over` gives fields their values, `{"contact.grain_grain_friction": [0.4, 0.6, 0.8]}`: every combination of several
    fields, or with `one_at_a_time` each by itself around the scenario. `samples` draws that many points from `ranges`,
    `{"contact.restitution": (0.1, 0.6)}`, by a Latin hypercube. `configurations` are realisations of each point: new
    random arrangements of the same grains. The rest is as of `run`.

    The same call resumes, or with more configurations adds to what is there. A run that fails is a row with the reason.
    """
    words = [f"--out={os.fspath(out)}", f"--configurations={configurations}"]
    for path, values in (over or {}).items():
        words.append(f"--over={path}=" + ",".join(as_value(value) for value in values))
    for path, (low, high) in (ranges or {}).items():
        words.append(f"--range={path}={as_value(low)}..{as_value(high)}")
    words += [] if samples is None else [f"--samples=latin-hypercube:{samples}"]
    words += ["--one-at-a-time"] if one_at_a_time else []
    words += options(changes, seed, backend, jobs)
    with as_file(scenario) as file:
        command(["sweep", *words, "--", file], progress)
    return Sweep(out)


def calibrate(
    scenario: Scenario,
    out: str | os.PathLike[str],
    *,
    angle_of_repose_degrees: float | None = None,
    target: Mapping[str, float] | None = None,
    unknown: str | None = None,
    between: tuple[float, float] | None = None,
    realisations: int | None = None,
    tolerance: float | None = None,
    most_runs: int | None = None,
    changes: Mapping[str, Any] | None = None,
    seed: int | None = None,
    backend: str | None = None,
    jobs: int | None = None,
    progress: Shown = True,
    replicates: object = None,
) -> Calibration:
    """Finds the value of a field of the scenario that gives a wanted result, with its interval.

    Either `angle_of_repose_degrees`, whose unknown is the friction between grains unless said otherwise; or `target`,
    one field of the summary with its value, `{"standing_height_mm.mean_surface": 105}`, with the `unknown` field of the
    scenario and the values `between` which it is sought. At each value `realisations` of the grains are run (5 unless
    given), until half of the 95 % interval of the result is within `tolerance`, or `most_runs` are used up. The rest is
    as of `run`; the same call resumes.

    Where no value gives the result, the answer's `found` is False and its `statement` says why: that is no exception.
    """
    if replicates is not None:
        raise TypeError("`replicates` is now called `realisations`")
    words = [f"--out={os.fspath(out)}"]
    if angle_of_repose_degrees is not None:
        words.append(f"--angle-of-repose={as_value(angle_of_repose_degrees)}")
    words += [f"--target={field}={as_value(value)}" for field, value in (target or {}).items()]
    words += [] if unknown is None else [f"--unknown={unknown}"]
    words += [] if between is None else [f"--between={as_value(between[0])}..{as_value(between[1])}"]
    words += [] if realisations is None else [f"--realisations={realisations}"]
    words += [] if tolerance is None else [f"--tolerance={as_value(tolerance)}"]
    words += [] if most_runs is None else [f"--most-runs={most_runs}"]
    words += options(changes, seed, backend, jobs)
    with as_file(scenario) as file:
        command(["calibrate", *words, "--", file], progress)
    return Calibration(out)


class _Study:
    """A folder of many runs."""

    _file = ""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        try:
            self.record: dict[str, Any] = _table.fields(self.folder / self._file)
            """The study's JSON file, as it is nested there."""
        except FileError:
            raise
        except OSError as error:
            raise FileError(f"{self.folder}: {error}") from None

    def run(self, name: str) -> Run:
        """One of the runs, by its name in the column `run`."""
        return Run(self.folder / "runs" / name)

    @property
    def report(self) -> Path:
        """The page that shows what was found."""
        return self.folder / "report.html"

    def _csv(self, name: str) -> pd.DataFrame:
        return _table.read_file(self.folder / name)


class Sweep(_Study):
    """What a sweep found."""

    _file = "sweep.json"

    def __repr__(self) -> str:
        return f"<pluvia.Sweep of {self.record['scenario']} in {self.folder}, {len(self.record['runs'])} runs>"

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row per run: its values of the fields and its results, by their paths in the summary; `valid`,
        `left_out_of_means` and `failure` say whether it counts, and why not."""
        return self._csv("sweep.csv")

    @cached_property
    def points(self) -> pd.DataFrame:
        """One row per point and result: the `mean` over its realisations that count, their `standard_deviation`, and the
        95 % confidence interval of the mean by Student's t, `t_low` to `t_high`."""
        fields = [factor["path"] for factor in self.record["factors"]]
        rows = [
            {"point": point["point"], **dict(zip(fields, point["values"])), "outcome": outcome, **estimate}
            for point in self.record["points"]
            for outcome, estimate in point["outcomes"].items()
        ]
        return _table.of(rows)

    @cached_property
    def effects(self) -> pd.DataFrame:
        """One row per field and result: the change of the result for one unit of the field, `slope`, with half of its 95 %
        confidence interval, `slope_half_width`."""
        return _table.of(self.record["effects"]).drop(columns="means", errors="ignore")


class Calibration(_Study):
    """What a calibration found."""

    _file = "calibrate.json"

    def __repr__(self) -> str:
        return f"<pluvia.Calibration in {self.folder}: {self.statement}>"

    @property
    def ending(self) -> str:
        """`found`, `runs_used_up`, `out_of_reach`, `flat` or, of a folder whose calibration failed, `failed`."""
        return str(self.record["ending"])

    @property
    def found(self) -> bool:
        """Whether a value was found with the certainty asked for."""
        return self.ending == "found"

    @property
    def statement(self) -> str:
        """The answer in a sentence."""
        return str(self.record["statement"])

    @property
    def value(self) -> float | None:
        """The value of the unknown that gives the wanted mean result; None if none does."""
        solution = self.record["solution"]
        return None if solution is None else float(solution["value"])

    @property
    def interval_95(self) -> tuple[float, float] | None:
        """Its 95 % confidence interval; None if it is unbounded, or there is no value."""
        solution = self.record["solution"]
        interval = None if solution is None else solution["interval_95"]
        return None if interval is None else (float(interval["low"]), float(interval["high"]))

    @cached_property
    def values(self) -> pd.DataFrame:
        """One row per value that was tried: the mean result of its realisations and its interval."""
        return _table.of(self.record["values"])

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row per run: value, realisation, result, and whether it counts."""
        return self._csv("evaluations.csv")


def load_sweep(folder: str | os.PathLike[str]) -> Sweep:
    """Opens the folder of a sweep."""
    return Sweep(folder)


def load_calibration(folder: str | os.PathLike[str]) -> Calibration:
    """Opens the folder of a calibration."""
    return Calibration(folder)
