"""Scenarios: files or dicts, those that come with the package, and changes of their fields."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ._errors import FileError, ScenarioError

Scenario = str | os.PathLike[str] | Mapping[str, Any]
"""A scenario: the path of its file, or its content as a dict. Relative paths in a dict count from the working
directory. Where that is read-only, a dict needs absolute paths: its file lies in the folder for temporary files."""

_FOLDER = Path(__file__).parent / "scenarios"


def examples() -> list[str]:
    """Names of the scenarios that come with the package, for `example`."""
    return sorted(str(path.relative_to(_FOLDER).with_suffix("")) for path in _FOLDER.rglob("*.json"))


def example(name: str) -> Path:
    """The file of a scenario that comes with the package, as `quick/pluviation`.

    Lay your own fields over it with `{"extends": pluvia.example("quick/pluviation"), ...}`.
    """
    path = _FOLDER / f"{name}.json"
    if not path.is_file():
        raise FileError(f"there is no example `{name}`; there are {', '.join(examples())}")
    return path


def _plain(value: object) -> object:
    """Paths and numpy's numbers as JSON has them."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    for method in ("item", "tolist"):
        # `item` of an array with many numbers fails.
        if hasattr(value, method) and (method == "tolist" or getattr(value, "size", 1) == 1):
            return getattr(value, method)()
    raise TypeError(f"{value!r} has no form in JSON")


def as_json(value: object) -> str:
    """A value as it stands in a scenario file."""
    try:
        return json.dumps(value, default=_plain, allow_nan=False, ensure_ascii=False)
    except (TypeError, ValueError) as error:
        raise ScenarioError(f"{value!r} cannot stand in a scenario: {error}") from error


@contextmanager
def as_file(scenario: Scenario) -> Iterator[str]:
    """The file of a scenario. That of a dict lies in the working directory, where its relative paths count from, or, if
    that is read-only, in the folder for temporary files, and is there only meanwhile."""
    if not isinstance(scenario, Mapping):
        yield os.fspath(scenario)
        return
    text = as_json(dict(scenario))
    folder: str | None = os.getcwd()
    if not os.access(os.getcwd(), os.W_OK):
        folder = None
    try:
        handle, path = tempfile.mkstemp(prefix=".pluvia-dict-", suffix=".json", dir=folder)
    except OSError as error:
        raise FileError(f"the dict could not be written for the program: {error}") from None
    try:
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                file.write(text)
        except OSError as error:
            raise FileError(f"{path}: the dict could not be written for the program: {error}") from None
        try:
            yield path
        except (ScenarioError, FileError) as error:
            # The dict has no file that a reader could look into.
            raise type(error)(str(error).replace(path, "the dict")) from None
    finally:
        os.unlink(path)


def as_value(value: object) -> str:
    """A value as after `path=` on a command line."""
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    return as_json(value)


def options(
    changes: Mapping[str, Any] | None,
    seed: int | None,
    backend: str | None,
    jobs: int | None,
) -> list[str]:
    """Options that commands have in common."""
    words = [f"--set={path}={as_value(value)}" for path, value in (changes or {}).items()]
    words += [] if seed is None else [f"--seed={seed}"]
    words += [] if backend is None else [f"--backend={backend}"]
    return words + ([] if jobs is None else [f"--jobs={jobs}"])
