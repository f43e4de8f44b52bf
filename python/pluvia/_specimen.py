"""A specimen at the end of a stage: its grains, its contacts, and what follows from them."""

from __future__ import annotations

import io
import os
from functools import cached_property
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import _measures, _pluvia
from ._errors import FileError

Array = npt.NDArray[np.float64]


class Specimen:
    """The specimen of a run folder at the end of a stage. `Run.at` makes it."""

    def __init__(self, folder: str | os.PathLike[str], stage: str | int | None = None) -> None:
        self.folder = Path(folder)
        try:
            self._native = _pluvia.Specimen.read(self.folder, None if stage is None else str(stage))
        except OSError as error:
            raise FileError(str(error)) from None

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
        """One row a grain: its size and shape as in `grains.csv` of the run, its fate, centroid (`x_mm`, `y_mm`, `z_mm`),
        orientation (`rotation_*`, a unit quaternion) and velocities at the end of the stage."""
        here = _frame(self._native.grains_csv())
        try:
            own = pd.read_csv(self.folder / "grains.csv")
        except OSError:
            return here
        of_grain = own.drop(columns=["speed_mm_per_s", *own.columns.intersection(here.columns).drop("grain")])
        return here.merge(of_grain, on="grain", how="left", validate="one_to_one")

    @cached_property
    def contacts(self) -> pd.DataFrame:
        """One row a loaded contact point: the two that touch, the point (`x_mm`, ...), the unit normal from the second to
        the first, the force on the first (`force_x_n`, ...), its part along the normal (`normal_force_n`, positive
        where it pushes) and across it. Without rows where the engine gives no contacts."""
        return _measures.with_parts_of_force(_frame(self._native.contacts_csv()))

    @cached_property
    def pairs(self) -> pd.DataFrame:
        """One row for every two grains that touch, measured outside the engine: `gap_mm`, negative where they overlap,
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
        return self._native.faces(grain)

    @property
    def area_m2(self) -> float:
        """Cross-section of the container in m²: of the cylinder or, without one, of the space around the grains."""
        return float(np.pi * self._native.container_m[1] ** 2)

    @cached_property
    def mean_surface_mm(self) -> float:
        """Height of the mean surface above the floor, as `standing_height_mm.mean_surface` of the summary."""
        return self._native.mean_surface_m() * 1000.0

    def void_profile(self, layers: int = 10, *, top_mm: float | None = None) -> pd.DataFrame:
        """Void ratio and porosity of horizontal layers of equal thickness, from the floor to `top_mm` (the mean surface
        unless given). Grains are cut exactly where layers meet; an empty layer has NaN."""
        if not 1 <= layers <= 100_000:
            raise ValueError(f"layers is {layers}, it must be from 1 to 100000")
        top = self.mean_surface_mm if top_mm is None else top_mm
        if not (np.isfinite(top) and top > 0.0):
            raise ValueError(f"top_mm is {top}, it must be a height above 0")
        low, high, solids, e = np.frombuffer(self._native.void_profile(top / 1000.0, layers)).reshape(-1, 4).T
        return pd.DataFrame(
            {
                "low_mm": low * 1000.0,
                "high_mm": high * 1000.0,
                "middle_mm": (low + high) * 500.0,
                "solids_cm3": solids * 1e6,
                "void_ratio": e,
                "porosity": e / (1.0 + e),
            }
        )

    def stress(self, *, low_mm: float | None = None, high_mm: float | None = None) -> Array:
        """Mean stress tensor in Pa, compression positive, by Love and Weber's sum over contact forces.

        Over the whole specimen up to its mean surface; or over a layer of it, between two heights above the floor:
        then contacts count whose point lies there."""
        if low_mm is None and high_mm is None:
            low, high, top = -np.inf, np.inf, self.mean_surface_mm
            volume = self.area_m2 * top / 1000.0
        else:
            low = 0.0 if low_mm is None else low_mm
            high = self.mean_surface_mm if high_mm is None else high_mm
            volume = self.area_m2 * (high - low) / 1000.0
        if not volume > 0.0:
            raise ValueError(f"there is no volume between low_mm={low} and high_mm={high}")
        return _measures.stress(self.contacts, self.positions, volume_m3=volume, low_mm=low, high_mm=high)

    def fabric(self) -> Array:
        """Fabric tensor of the contacts between grains; see `pluvia.fabric`."""
        return _measures.fabric(self.contacts)

    def force_distribution(self, *, bins: int = 30) -> pd.DataFrame:
        """Distribution of the normal forces between grains; see `pluvia.force_distribution`."""
        return _measures.force_distribution(self.contacts, bins=bins)


def _frame(table: bytes) -> pd.DataFrame:
    return pd.read_csv(io.BytesIO(table))
