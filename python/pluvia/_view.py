"""The viewer's page, in a notebook or a browser."""

from __future__ import annotations

import html
import os
import tempfile
import webbrowser
from pathlib import Path

from ._command import command


class View:
    """A run as one page that plays it in three dimensions (WebGL 2), with the run inside."""

    def __init__(self, folder: str | os.PathLike[str], *, height_px: int = 600) -> None:
        self.height_px = height_px
        """Height of the page in a notebook."""
        with tempfile.TemporaryDirectory(prefix="pluvia-") as made:
            file = Path(made) / "run.html"
            command(["view", f"--save={file}", "--", os.fspath(folder)], False)
            self.html = file.read_text(encoding="utf-8")
            """The whole page."""
        self._folder = Path(folder)

    def __repr__(self) -> str:
        return f"<pluvia.View of {self._folder}; .open() shows it in a browser, .save(file) keeps it>"

    def _repr_html_(self) -> str:
        page = html.escape(self.html, quote=True)
        return f'<iframe srcdoc="{page}" width="100%" height="{self.height_px}" style="border:0"></iframe>'

    def save(self, file: str | os.PathLike[str]) -> Path:
        """Writes the page into a file, over what is there."""
        path = Path(file)
        path.write_text(self.html, encoding="utf-8")
        return path

    def open(self) -> Path:
        """Opens the page in a browser, from a temporary file that stays."""
        handle, name = tempfile.mkstemp(prefix="pluvia-", suffix=".html")
        os.close(handle)
        path = self.save(name)
        webbrowser.open(path.as_uri())
        return path
