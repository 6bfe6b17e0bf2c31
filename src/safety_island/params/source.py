# SPDX-License-Identifier: Apache-2.0
"""The text of a parameter file, and the name under which errors speak of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from safety_island.params.problem import Place, Problem
from safety_island.text_file import UnreadableError, read_text

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
        return Source(str(path), read_text(path, MAX_FILE_BYTES))
    except UnreadableError as why:
        text = f"cannot be read: {why}; expected a YAML file of parameters"
        return Problem(Place(str(path)), "", text)
