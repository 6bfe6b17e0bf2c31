# SPDX-License-Identifier: Apache-2.0
"""How one parameter is declared: its key, unit, meaning and what is allowed."""

from __future__ import annotations

from dataclasses import Field, field
from typing import Any


def parameter(
    unit: str,
    doc: str,
    low: float = float("-inf"),
    high: float = float("inf"),
    *,
    key: str | None = None,
    choices: tuple[str, ...] | None = None,
) -> Any:
    """Declare a parameter: its unit, what it means, the closed range that is allowed.

    ``key`` is its name in a YAML file where that differs from the field (a dot in it), ``choices``
    are the words that a text may be. The range of a list is the range of each of its entries.
    """
    meta = {"unit": unit, "doc": doc, "low": low, "high": high, "key": key, "choices": choices}
    return field(metadata=meta)


def switch(doc: str, *, key: str | None = None) -> Any:
    """Declare a parameter that is true or false."""
    return parameter("", doc, key=key)


def weight(doc: str) -> Any:
    """Declare a weight of the MPC's cost; 0 leaves its term out."""
    return parameter("", doc, 0.0, 1e6)


def key_of(item: Field[Any]) -> str:
    """Return the name that a parameter has in a YAML file."""
    return item.metadata["key"] or item.name
