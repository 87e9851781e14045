# SPDX-License-Identifier: BSD-3-Clause
"""Answers as pages."""
from __future__ import annotations

import errno
import os


def require_folder_of(path: str | os.PathLike[str]) -> None:
    """Raises FileNotFoundError where a file can't be written, as its folder is not there: before long work."""
    folder = os.path.dirname(os.path.abspath(path))
    if not os.path.isdir(folder):
        raise FileNotFoundError(errno.ENOENT, "no such folder", folder)


class Report:
    """A page for a browser, whole in itself: ``html`` is its text. Notebooks show it."""

    def __init__(self, html: str, title: str) -> None:
        self.html = html
        self.title = title

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the page as an HTML file."""
        content = self.html.encode()
        with open(path, "wb") as file:
            file.write(content)

    def _repr_html_(self) -> str:
        # In a frame of its own: neither its style nor its script meets the notebook's.
        page, title = (text.replace("&", "&amp;").replace('"', "&quot;") for text in (self.html, self.title))
        return (
            f'<iframe title="{title}" sandbox="allow-scripts" srcdoc="{page}" '
            'style="width: 100%; height: 720px; border: 1px solid #8888"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<Report: {self.title}, {len(self.html) / 1e6:.1f} MB>"
