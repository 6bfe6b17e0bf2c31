# SPDX-License-Identifier: Apache-2.0
"""Whether a value is allowed for a parameter, and which key a misspelt one was meant to be."""

from __future__ import annotations

from difflib import SequenceMatcher
from typing import Any

from safety_island.params.scalars import found
from safety_island.params.schema import KNOWN, Known

_LIKELY = 0.8
"""Likeness of a long key and its misspelt form; less is a likeness of letters, not of meaning."""


class NotAllowedError(ValueError):
    """A value that a parameter may not have; the text says what was found and what is allowed."""


def convert(known: Known, value: Any) -> Any:
    """Return the value with the type of the parameter, a whole number for a float as a float.

    Raises NotAllowedError.
    """
    if known.kind == "list":
        if isinstance(value, list | tuple) and 1 <= len(value) <= known.most_entries:
            return tuple(_number(known, item) for item in value)
    elif known.kind in ("float", "int"):
        return _number(known, value)
    elif known.kind == "bool":
        if isinstance(value, bool):
            return value
    elif isinstance(value, float) and f"{value:.2f}" in known.choices:
        return f"{value:.2f}"  # a release without quotes is a number to YAML
    elif isinstance(value, str) and (value in known.choices or not known.choices):
        return value
    raise _not_allowed(known, value)


def _number(known: Known, value: Any) -> float | int:
    """Return a number in range; NaN is in none, and true is no number."""
    number = isinstance(value, int if known.kind == "int" else (int, float))
    if number and not isinstance(value, bool) and known.low <= value <= known.high:
        return int(value) if known.kind == "int" else float(value)
    raise _not_allowed(known, value)


def _not_allowed(known: Known, value: Any) -> NotAllowedError:
    return NotAllowedError(f"found {found(value)}; expected {known.allowed_text}")


def nearest(key: str, keys: tuple[str, ...] = tuple(KNOWN)) -> str:
    """Return the key or keys most like a misspelt one, joined by 'or'; empty when none is."""
    leaves = [name for name in keys if name.rpartition(".")[2] == key]
    likeness = {name: SequenceMatcher(None, name, key).ratio() for name in keys}
    likely = [name for name in keys if likeness[name] >= _likely(name, key)]
    best = max((likeness[name] for name in likely), default=0.0)
    return " or ".join(leaves or [name for name in likely if likeness[name] == best][:3])


def _likely(name: str, key: str) -> float:
    """Likeness from which on one is the other misspelt: one letter in five, or in a short name."""
    shortest = min(len(name), len(key))
    return min(_LIKELY, (shortest - 1) / shortest) if shortest > 1 else 1.0
