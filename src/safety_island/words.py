# SPDX-License-Identifier: Apache-2.0
"""How names are told to a person: the nearest one to a slip of the pen, an enumeration's words."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from enum import Enum

LIKE = 0.6
"""How alike two names must be, 0 to 1, for one to be offered in place of the other."""


def nearest(name: str, names: Iterable[str], like: float = LIKE) -> str | None:
    """Return the name that is most like another one, None when none is like it."""
    found = get_close_matches(name, list(names), n=1, cutoff=like)
    return found[0] if found else None


def did_you_mean(name: str, names: Iterable[str], like: float = LIKE) -> str:
    """Return ``; did you mean 'x'?`` for the end of an error, empty when no name is like it."""
    found = nearest(name, names, like)
    return "" if found is None else f"; did you mean '{found}'?"


def words_of(member: Enum) -> str:
    """Return the name of an enumeration's member in words: STEERING_ANGLE is 'steering angle'."""
    return in_words(str(member.name))


def in_words(name: str) -> str:
    """Return a name that programs read as a person reads it: NOT_READY is 'not ready'."""
    return name.lower().replace("_", " ")
