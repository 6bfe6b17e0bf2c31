"""The text of a parameter file, and the name under which errors speak of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from safety_island.params.problem import Place, Problem

MAX_FILE_BYTES = 1 << 16
"""A parameter file has a few kB; a file beyond this is not one."""


@dataclass(frozen=True)
class Source:
    """One file."""

    name: str
    text: str


def read_source(path: Path) -> Source | Problem:
    """Read a file of the user; a Problem says why it cannot be read."""
    try:
        return Source(str(path), _text(path))
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or str(error)
        text = f"cannot be read: {why}; expected a YAML file of parameters"
        return Problem(Place(str(path)), "", text)


def _text(path: Path) -> str:
    with path.open("rb") as stream:
        data = stream.read(MAX_FILE_BYTES + 1)
    if len(data) > MAX_FILE_BYTES:
        raise ValueError(f"has more than {MAX_FILE_BYTES} bytes")
    return data.decode("utf-8-sig")
