# SPDX-License-Identifier: Apache-2.0
"""Turns the words of ``--params`` and ``--period`` into a checked parameter set."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from safety_island.cli.parser import UsageError
from safety_island.params import Loaded, read

DEFAULT = "default"


def read_parameters(words: Sequence[str], period_s: float | None = None) -> Loaded:
    """Read a set by name (at most one, default: ``default``) and files over it, in their order.

    A word with a slash or an ending is a file, another one names a set. Raises ParameterError with
    every mistake, and UsageError for two sets.
    """
    sets = [word for word in words if is_set_name(word)]
    if len(sets) > 1:
        raise UsageError(f"two parameter sets, '{sets[0]}' and '{sets[1]}'; name at most one")
    files = [Path(word) for word in words if not is_set_name(word)]
    overrides = {} if period_s is None else {"ctrl_period": period_s}
    return read(files, sets[0] if sets else DEFAULT, overrides, name="--period")


def is_set_name(word: str) -> bool:
    """Whether a word names a parameter set rather than a file."""
    return "/" not in word and not word.endswith((".yaml", ".yml"))
