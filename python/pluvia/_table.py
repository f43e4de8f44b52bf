"""Tables and fields of files: what is missing is NaN in every frame, whatever it comes from."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from ._errors import FileError


def read(table: Path | io.BytesIO) -> pd.DataFrame:
    """A CSV table of the program: an empty cell is missing, and a piece may be called `NA` or `None`."""
    return pd.read_csv(table, keep_default_na=False, na_values=["", "NaN"])


def read_file(path: Path) -> pd.DataFrame:
    """The same of a file, which may be damaged."""
    try:
        return read(path)
    except OSError as error:
        raise FileError(str(error)) from None
    except ValueError as error:
        raise FileError(f"{path} is not a table: {error}") from None


def fields(path: Path) -> dict[str, Any]:
    """The fields of a JSON file; an `OSError` where it cannot be read."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise FileError(f"{path} is not JSON: {error}") from None
    if not isinstance(content, dict):
        raise FileError(f"{path} has no fields: it holds {type(content).__name__}, not an object")
    return content


def of(rows: Iterable[Mapping[str, Any]]) -> pd.DataFrame:
    """Rows from JSON, in which `null` is missing."""
    return pd.DataFrame([{name: math.nan if value is None else value for name, value in row.items()} for row in rows])
