"""Measures of a table of contacts: pure functions of `Run.contacts` or `Specimen.contacts`."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pandas as pd

Array = npt.NDArray[np.float64]

_POINT = ["x_mm", "y_mm", "z_mm"]
_NORMAL = ["normal_x", "normal_y", "normal_z"]
_FORCE = ["force_x_n", "force_y_n", "force_z_n"]


def grain_numbers(names: pd.Series[str]) -> npt.NDArray[np.int64]:
    """Numbers of grains by their names, `grain_00012`; -1 of what is no grain."""
    found = names.str.extract(r"^grain_(\d+)$")[0].fillna("-1")
    return found.to_numpy(dtype=np.int64)


def between_grains(contacts: pd.DataFrame) -> npt.NDArray[np.bool_]:
    """Whether both of a contact are grains."""
    first, second = grain_numbers(contacts["first"]), grain_numbers(contacts["second"])
    return (first >= 0) & (second >= 0)


def with_parts_of_force(contacts: pd.DataFrame) -> pd.DataFrame:
    """The contacts with the parts of their forces along the normal (positive where it pushes) and across it, in N."""
    force, normal = contacts[_FORCE].to_numpy(float), contacts[_NORMAL].to_numpy(float)
    along = np.einsum("ij,ij->i", force, normal)
    across = np.linalg.norm(force - along[:, None] * normal, axis=1)
    return contacts.assign(normal_force_n=along, tangential_force_n=across)


def stress(
    contacts: pd.DataFrame,
    positions: Array,
    *,
    volume_m3: float,
    low_mm: float = -np.inf,
    high_mm: float = np.inf,
) -> Array:
    """Mean stress tensor in Pa over a volume, compression positive (Love 1927, Weber 1966).

    sigma_ij = (1/V) sum f_i l_j over the contacts whose points lie from `low_mm` to `high_mm` above the floor: f the
    force on the first of a contact, l the vector from the centroid of the second to that of the first. Of a wall, plate
    or floor the point of contact takes the centroid's place. `positions` are the grains' centroids in m.
    """
    heights = contacts["z_mm"].to_numpy(float)
    contacts = contacts[(heights >= low_mm) & (heights <= high_mm)]
    points = contacts[_POINT].to_numpy(float) / 1000.0
    ends = []
    for who in ("first", "second"):
        number = grain_numbers(contacts[who])
        known = positions[number] if len(positions) else points
        ends.append(np.where((number >= 0)[:, None], known, points))
    branch = ends[0] - ends[1]
    force = contacts[_FORCE].to_numpy(float)
    total: Array = np.einsum("ci,cj->ij", force, branch) / volume_m3
    return total


def fabric(contacts: pd.DataFrame) -> Array:
    """Fabric tensor of the contacts between grains: the mean of n n^T over their unit normals, every contact point
    counting alike. Its trace is 1; a third of the unit tensor where no direction is preferred; NaN without contacts."""
    normals = contacts[between_grains(contacts)][_NORMAL].to_numpy(float)
    if len(normals) == 0:
        return np.full((3, 3), np.nan)
    mean: Array = np.einsum("ci,cj->ij", normals, normals) / len(normals)
    return mean


def force_distribution(contacts: pd.DataFrame, *, bins: int = 30) -> pd.DataFrame:
    """Probability density of the normal force of pairs of grains, over its mean.

    A pair's force is the sum over its contact points. Columns: `low`, `high` and `middle` of a bin in multiples of the
    mean, `pairs` in it, `probability_density`, whose integral is 1. `attrs["mean_normal_force_n"]` is the mean in N.
    """
    if bins < 1:
        raise ValueError(f"bins is {bins}, it must be at least 1")
    pairs = with_parts_of_force(contacts[between_grains(contacts)])
    forces = pairs.groupby(["first", "second"])["normal_force_n"].sum().to_numpy(float)
    mean = float(forces.mean()) if len(forces) else float("nan")
    counts, edges = np.zeros(0, int), np.zeros(1)
    if len(forces):
        counts, edges = np.histogram(forces / mean, bins=bins, range=(0.0, float(forces.max()) / mean))
    low, high = edges[:-1], edges[1:]
    density = counts / (max(len(forces), 1) * (high - low))
    frame = pd.DataFrame(
        {"low": low, "high": high, "middle": (low + high) / 2.0, "pairs": counts, "probability_density": density}
    )
    frame.attrs["mean_normal_force_n"] = mean
    return frame
