# SPDX-License-Identifier: Apache-2.0
"""Lines of a configuration fragment: ``CONFIG_NAME=value`` and ``# CONFIG_NAME is not set``."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from safety_island.errors import ConfigurationError
from safety_island.text_file import UnreadableError, read_text

PREFIX = "CONFIG_"
OVERRIDE = "-D"
_SET = re.compile(rf"{PREFIX}([A-Za-z0-9_]+)=(.*)")
_UNSET = re.compile(rf"# {PREFIX}([A-Za-z0-9_]+) is not set\s*")
_TEXT = re.compile(r'"((?:[^"\\]|\\.)*)"')


class Assignment(NamedTuple):
    """One symbol set to one value, at a place; ``value`` is as written, quotes included."""

    symbol: str
    value: str
    place: str

    def __str__(self) -> str:
        return f"{PREFIX}{self.symbol}={self.value}"

    @property
    def is_override(self) -> bool:
        """Whether it was given on the command line, where a shell takes quotes away."""
        return self.place.startswith(f"{OVERRIDE} ")


def shown(path: Path) -> str:
    """Return a path as messages show it: relative when it is below the current folder."""
    absolute = path.absolute()
    return str(absolute.relative_to(Path.cwd()) if absolute.is_relative_to(Path.cwd()) else path)


def read_fragment(path: Path) -> list[Assignment]:
    """Read a fragment. Raises ConfigurationError with every line that cannot be read."""
    name = shown(path)
    try:
        text = read_text(path)
    except UnreadableError as why:
        raise ConfigurationError(f"{name}: cannot read this configuration: {why}") from None
    return read_lines(text, name)


def read_lines(text: str, name: str) -> list[Assignment]:
    """Read the text of a fragment or a ``.config``; ``name`` is how its places are told.

    Raises ConfigurationError with every line that cannot be read.
    """
    found: list[Assignment] = []
    mistakes: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        place = f"{name}:{number}"
        assignment = _read_line(line, place)
        if assignment is not None:
            found.append(assignment)
        elif line.strip() and not line.lstrip().startswith("#"):
            mistakes.append(
                f"{place}: cannot read '{line.strip()}', expected {PREFIX}NAME=value from the "
                "first column on"
            )
    if mistakes:
        raise ConfigurationError("\n".join(mistakes))
    return found


def _read_line(line: str, place: str) -> Assignment | None:
    """The assignment in a line, None for anything else."""
    if match := _SET.fullmatch(line):
        return Assignment(match[1], match[2].rstrip(), place)
    if match := _UNSET.fullmatch(line):
        return Assignment(match[1], "n", place)
    return None


def read_override(text: str) -> Assignment:
    """Read ``NAME=value`` of ``-D``; the prefix may be left out. Raises ConfigurationError."""
    line = text if text.startswith(PREFIX) else PREFIX + text
    assignment = _read_line(line, f"{OVERRIDE} {text}")
    if assignment is None:
        raise ConfigurationError(f"{OVERRIDE} {text}: expected NAME=value, for example LOG_LEVEL=2")
    return assignment


def unquote(value: str) -> str | None:
    """Return the text between the quotes of a string value, None when it is not quoted."""
    match = _TEXT.fullmatch(value)
    return re.sub(r"\\(.)", r"\1", match[1]) if match else None


def quote(text: str) -> str:
    """Return a text as a string value."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
