"""Tables: what is missing is NaN in every frame, whatever it comes from."""

from __future__ import annotations

import io
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd


def read(table: Path | io.BytesIO) -> pd.DataFrame:
    """A CSV table of the program: an empty cell is missing, and a piece may be called `NA` or `None`."""
    return pd.read_csv(table, keep_default_na=False, na_values=["", "NaN"])


def of(rows: Iterable[Mapping[str, Any]]) -> pd.DataFrame:
    """Rows from JSON, in which `null` is missing."""
    return pd.DataFrame([{name: math.nan if value is None else value for name, value in row.items()} for row in rows])
