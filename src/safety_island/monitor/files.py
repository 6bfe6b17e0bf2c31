# SPDX-License-Identifier: Apache-2.0
"""The files of the page, read once; nothing outside the package is ever served."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import NamedTuple

HEADERS: Mapping[str, str] = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; "
    "img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-cache",
}
"""Sent with every file: no script but the page's own files, no frame around it, no other host."""
INDEX = "/index.html"
_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
}


class StaticFile(NamedTuple):
    """One file and what a browser is to take it for."""

    content_type: str
    body: bytes


def load_page() -> dict[str, StaticFile]:
    """Return every file of the page by the path of its address; ``/`` is the index."""
    found = dict(_below(files(__package__).joinpath("page"), "/"))
    found["/"] = found[INDEX]
    return found


def _below(folder: Traversable, path: str) -> Iterator[tuple[str, StaticFile]]:
    for item in folder.iterdir():
        if item.is_dir():
            yield from _below(item, f"{path}{item.name}/")
        elif kind := next((t for end, t in _TYPES.items() if item.name.endswith(end)), None):
            yield f"{path}{item.name}", StaticFile(kind, item.read_bytes())
