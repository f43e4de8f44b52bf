"""A specimen at the end of a stage: its grains, its contacts, and what follows from them."""

from __future__ import annotations

import io
import os
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import _pluvia, _table
from ._errors import FileError, ScenarioError

Array = npt.NDArray[np.float64]


class Specimen:
    """The specimen of a run folder at the end of a stage. `Run.at` makes it."""

    def __init__(self, folder: str | os.PathLike[str], stage: str | int | None = None) -> None:
        self.folder = Path(folder)
        try:
            self._native = _pluvia.Specimen.read(self.folder, None if stage is None else str(stage))
        except OSError as error:
            raise FileError(str(error)) from None
        except ValueError as error:
            raise ScenarioError(str(error)) from None

    def __repr__(self) -> str:
        return f"<pluvia.Specimen of {self.folder} at the end of {self.stage}, {self.present.sum()} grains>"

    @property
    def stage(self) -> str:
        """Name of the stage at whose end it is."""
        return self._native.stage

    @property
    def time_s(self) -> float:
        """Simulated time since the first stage began, in s."""
        return self._native.time_s

    @cached_property
    def grains(self) -> pd.DataFrame:
        """One row per grain: size and shape as in `grains.csv` of the run, fate, centroid (`x_mm`, `y_mm`, `z_mm`),
        orientation (`rotation_*`, a unit quaternion) and velocities at the end of the stage."""
        here = _frame(self._native.grains_csv())
        path = self.folder / "grains.csv"
        if not path.exists():
            return here
        own = _table.read_file(path)
        if "grain" not in own or own["grain"].duplicated().any():
            raise FileError(f"{path} has no column `grain` with the name of one grain per row")
        # What is of another moment is left out.
        there = own.columns.intersection(["speed_mm_per_s", "turned_deg", *here.columns]).drop("grain")
        of_grain = own.drop(columns=there)
        return here.merge(of_grain, on="grain", how="left", validate="one_to_one")

    @cached_property
    def contacts(self) -> pd.DataFrame:
        """One row per loaded contact point: the two bodies, the point (`x_mm`, ...), the unit normal from the second to
        the first, the force on the first (`force_x_n`, ...), its parts along the normal (`normal_force_n`, positive
        where it pushes) and across it (`tangential_force_n`). No rows where the engine gives no contacts."""
        contacts = _frame(self._native.contacts_csv())
        force = contacts[["force_x_n", "force_y_n", "force_z_n"]].to_numpy(float)
        normal = contacts[["normal_x", "normal_y", "normal_z"]].to_numpy(float)
        along = np.einsum("ij,ij->i", force, normal)
        across = np.linalg.norm(force - along[:, None] * normal, axis=1)
        return contacts.assign(normal_force_n=along, tangential_force_n=across)

    @cached_property
    def pairs(self) -> pd.DataFrame:
        """One row per pair of grains that touch, measured outside the engine: `gap_mm`, negative where they overlap,
        and `overlap_percent` of the mean of their equivalent diameters."""
        return _frame(self._native.pairs_csv())

    @cached_property
    def positions(self) -> Array:
        """Centroids in m, of the shape (grains, 3); z points up, 0 is the floor."""
        return np.frombuffer(self._native.positions()).reshape(-1, 3)

    @cached_property
    def orientations(self) -> Array:
        """Unit quaternions x, y, z, w that turn each grain's principal axes into the world's, of the shape (grains, 4)."""
        return np.frombuffer(self._native.orientations()).reshape(-1, 4)

    @cached_property
    def present(self) -> npt.NDArray[np.bool_]:
        """Whether each grain still takes part: those that were spilled or left in the funnel do not."""
        return np.array(self._native.present, dtype=bool)

    @cached_property
    def hulls(self) -> list[Array]:
        """Corners of each grain where it is, in m: arrays of the shape (corners, 3)."""
        return self._corners(local=False)

    @cached_property
    def local_hulls(self) -> list[Array]:
        """Corners of each grain about its centroid, in its principal axes, in m."""
        return self._corners(local=True)

    def _corners(self, *, local: bool) -> list[Array]:
        corners, counts = self._native.hulls(local)
        ends = np.cumsum(np.frombuffer(counts, dtype=np.int64))
        return np.split(np.frombuffer(corners).reshape(-1, 3), ends[:-1]) if len(ends) else []

    def faces(self, grain: int) -> list[list[int]]:
        """Faces of a grain: numbers of the corners in `hulls`, counter-clockwise seen from outside."""
        if grain < 0:
            raise ValueError(f"grain is {grain}; grains are numbered from 0")
        return self._native.faces(grain)

    @property
    def has_cylinder(self) -> bool:
        """Whether the grains lie in the built-in cylinder: neither on a pile's base nor among pieces of a laboratory."""
        return self._native.no_cylinder is None

    def _need_cylinder(self) -> None:
        if (why := self._native.no_cylinder) is not None:
            raise ValueError(why)

    @property
    def area_m2(self) -> float:
        """Cross-section of the cylinder in m². Without one it is that of a pile's base, or of the circle around all grains
        of a laboratory, which is not their container."""
        return self._native.area_m2

    @cached_property
    def mean_surface_mm(self) -> float:
        """Height of the mean surface above the floor, as `standing_height_mm.mean_surface` of the summary."""
        return self._native.mean_surface_m() * 1000.0

    def _between(self, low_mm: float, high_mm: float | None) -> tuple[float, float]:
        """Two heights in m; the higher that of the mean surface unless given."""
        high = self.mean_surface_mm if high_mm is None else high_mm
        if not (np.isfinite(low_mm) and np.isfinite(high) and low_mm < high):
            raise ValueError(f"low_mm is {low_mm} and high_mm {high}: they must be heights, the second above the first")
        return low_mm / 1000.0, high / 1000.0

    def void_profile(
        self,
        count: int = 10,
        *,
        by: Literal["height", "radius"] = "height",
        low_mm: float = 0.0,
        high_mm: float | None = None,
    ) -> pd.DataFrame:
        """Void ratio and porosity of `count` layers of equal thickness, or by `"radius"` of rings of equal width about the
        container's axis, between two heights above the floor (up to the mean surface unless given). Grains count in
        each with the part that lies there, exactly; without grains the void ratio is NaN.

        Refused (`ValueError`) without a cylinder (`has_cylinder`): of a laboratory `series` has the void ratios of
        regions."""
        self._need_cylinder()
        if not 1 <= count <= 100_000:
            raise ValueError(f"count is {count}, it must be from 1 to 100000")
        if by not in ("height", "radius"):
            raise ValueError(f'by is {by!r}, it must be "height" or "radius"')
        low, high = self._between(low_mm, high_mm)
        slices = np.frombuffer(self._native.void_profile(by == "radius", low, high, count)).reshape(-1, 4)
        begin, end, solids, e = slices.T
        return pd.DataFrame(
            {
                "from_mm": begin * 1000.0,
                "to_mm": end * 1000.0,
                "middle_mm": (begin + end) * 500.0,
                "solids_mm3": solids * 1e9,
                "void_ratio": e,
                "porosity": e / (1.0 + e),
            }
        )

    def stress(self, *, low_mm: float = 0.0, high_mm: float | None = None) -> Array:
        """Mean stress tensor in Pa between two heights above the floor, up to the mean surface unless given; 3 × 3,
        compression positive.

        By Love and Weber's sum of contact forces over the lines between centroids and contact points, of which the
        parts count that lie between the heights. NaN where the engine gives no contacts.

        Refused (`ValueError`) without a cylinder (`has_cylinder`): of a laboratory `series` has the stresses of
        regions."""
        self._need_cylinder()
        return _tensor(self._native.stress(*self._between(low_mm, high_mm)))

    def fabric(self, *, low_mm: float | None = None, high_mm: float | None = None) -> Array:
        """Fabric tensor of the contacts between grains, each counted once: the mean of n n^T over their unit normals,
        3 × 3. Its trace is 1; a third of the unit tensor where no direction is preferred. Of all contacts, or of those
        between two heights above the floor. NaN without contacts."""
        low = -np.inf if low_mm is None else low_mm / 1000.0
        high = np.inf if high_mm is None else high_mm / 1000.0
        return _tensor(self._native.fabric(low, high))

    def force_distribution(self) -> pd.DataFrame:
        """Distribution of the normal forces between grains, each contact counted once.

        One row per class, from `low` to `high` times the mean (the last is open): the `share` of all contacts, and the
        `probability_density` of the force over its mean. `attrs` has the mean in N, `mean_normal_force_n`, and the
        percentiles `p10_of_mean`, `p50_of_mean`, `p90_of_mean`, `p99_of_mean` and `max_of_mean`. No rows without
        contacts."""
        found = self._native.force_distribution()
        mean, width, classes, percentiles = found or (float("nan"), 1.0, [], [float("nan")] * 5)
        share = np.array(classes, dtype=float)
        low = width * np.arange(len(share))
        high = low + width
        high[len(share) - 1 :] = np.inf
        frame = pd.DataFrame({"low": low, "high": high, "share": share, "probability_density": share / (high - low)})
        names = ("p10_of_mean", "p50_of_mean", "p90_of_mean", "p99_of_mean", "max_of_mean")
        frame.attrs.update({"mean_normal_force_n": mean, **dict(zip(names, percentiles))})
        return frame

    @cached_property
    def loaded(self) -> pd.DataFrame:
        """One row per contact between grains, with all its points: height `z_mm`, upward part of the unit normal
        `normal_z`, `normal_force_n`, and whether it `slides`: all points bear as much friction as they can."""
        z, upward, force, slides = np.frombuffer(self._native.loaded()).reshape(-1, 4).T
        return pd.DataFrame({"z_mm": z * 1000.0, "normal_z": upward, "normal_force_n": force, "slides": slides > 0.5})


def _tensor(numbers: bytes | None) -> Array:
    return np.full((3, 3), np.nan) if numbers is None else np.frombuffer(numbers).reshape(3, 3)


def _frame(table: bytes) -> pd.DataFrame:
    return _table.read(io.BytesIO(table))
