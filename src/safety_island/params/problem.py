# SPDX-License-Identifier: Apache-2.0
"""What is wrong with a parameter file, and where."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from safety_island.errors import ConfigurationError


@dataclass(frozen=True)
class Place:
    """A file (or another source of values) and, where there is one, a line of it."""

    source: str
    line: int | None = None

    def __str__(self) -> str:
        return self.source if self.line is None else f"{self.source}:{self.line}"


@dataclass(frozen=True)
class Problem:
    """One mistake: where, at which key (may be empty), what was found and what is allowed.

    As a text it is one line, whatever the file holds.
    """

    place: Place
    key: str
    text: str

    def __str__(self) -> str:
        key = f"{self.key}: " if self.key else ""
        return " ".join(f"{self.place}: {key}{self.text}".split())


class ParameterError(ConfigurationError):
    """All problems of all parameter files together, one line each."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))
