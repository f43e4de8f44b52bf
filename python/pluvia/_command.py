"""Commands of the program, run within this process."""

from __future__ import annotations

import json
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from . import _pluvia
from ._errors import ScenarioWarning, raised


class Progress(NamedTuple):
    """How far a call has come."""

    stage: str
    """The stage that has just advanced."""
    done: float
    """What is done of all stages, in simulated seconds (or pieces of work)."""
    total: float
    """What is expected in all, in the same unit."""
    note: str
    """What matters most now, such as the height of the surface; may be empty."""


Shown = bool | Callable[[Progress], object]
"""How progress is shown: True for a bar in the terminal or notebook, False for nothing, or a function to call."""


def command(words: Sequence[str], progress: Shown) -> tuple[bool, Any]:
    """Runs a command; gives whether its expectations were met, and its result."""
    bar = _Bar() if progress is True else None
    if bar is not None:
        hear: Callable[[Progress], object] = bar.update
    else:
        hear = progress if callable(progress) else _nothing
    try:
        code, printed, error = _pluvia.command(
            list(words),
            bar.message if bar is not None else _message,
            lambda *far: hear(Progress(*far)),
        )
    finally:
        if bar is not None:
            bar.close()
    if error is not None:
        raise raised(code, error)
    return code == 0, json.loads(printed) if printed.strip() else None


def info() -> dict[str, Any]:
    """Versions, engines with their precision, features, and the number of cores."""
    found: dict[str, Any] = command(["info"], False)[1]
    return found


def schema() -> dict[str, Any]:
    """The JSON Schema of a scenario."""
    found: dict[str, Any] = command(["schema"], False)[1]
    return found


def _nothing(_: Progress) -> None:
    pass


def _message(text: str) -> None:
    """Without a bar only warnings are passed on."""
    if text.startswith("warning"):
        warnings.warn(text, ScenarioWarning, stacklevel=4)


class _Bar:
    """A bar of simulated time, in the terminal or a notebook."""

    def __init__(self) -> None:
        with warnings.catch_warnings():
            # Without ipywidgets a notebook shows the terminal's bar, which does as well.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
        # In files a line every ten seconds is enough.
        watched = sys.stderr.isatty() or "ipykernel" in sys.modules
        self._new: Callable[[float], Any] = lambda total: tqdm(
            total=total,
            unit="s",
            mininterval=0.1 if watched else 10.0,
            bar_format="{desc}{percentage:3.0f}%|{bar}| {n:.2f}/{total:.2f} s done [{elapsed}<{remaining}{postfix}]",
            file=sys.stderr,
        )
        self._write: Callable[..., Any] = tqdm.write
        self._bar: Any = None

    def message(self, text: str) -> None:
        self._write(text, file=sys.stderr)

    def update(self, far: Progress) -> None:
        if far.total <= 0.0:
            return
        if self._bar is None:
            self._bar = self._new(far.total)
        bar = self._bar
        bar.total = far.total
        bar.set_description(far.stage, refresh=False)
        bar.set_postfix_str(far.note, refresh=False)
        # A stage may begin anew, or be found done.
        if far.done >= bar.n:
            bar.update(far.done - bar.n)
        else:
            bar.n = far.done

    def close(self) -> None:
        if self._bar is not None:
            self._bar.refresh()
            self._bar.close()
