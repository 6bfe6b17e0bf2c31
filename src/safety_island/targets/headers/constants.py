# SPDX-License-Identifier: Apache-2.0
"""Sizes and enumerations of the rooms of kernels as C constants."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from enum import Enum

from safety_island.command import encoding
from safety_island.control import limits, status
from safety_island.control.longitudinal_state import LIST_CAPACITY
from safety_island.guard import limit
from safety_island.guard.records import MAX_SPEED_POINTS
from safety_island.input_gate.clock.records import MAX_INPUTS
from safety_island.kernel import cdr
from safety_island.life_cycle import limits as life_cycle_limits
from safety_island.life_cycle import params, reason, state

_MACRO = "SAFETY_ISLAND_"
_SIZES = (limits, life_cycle_limits)
_ENUMERATIONS = (status, state, reason, params, limit, encoding, cdr)


def sizes() -> Iterator[str]:
    """Yield a line for each bound of an array."""
    known = {name: value for module in _SIZES for name, value in vars(module).items()}
    found = {name: value for name, value in known.items() if name.startswith("MAX_")}
    own = {
        "LIST_CAPACITY": LIST_CAPACITY,
        "MAX_SPEED_POINTS": MAX_SPEED_POINTS,
        "MAX_INPUTS": MAX_INPUTS,
    }
    for name, value in (found | own).items():
        yield f"#define {_MACRO}{name} {value}"


def enumerations() -> Iterator[str]:
    """Yield the lines of each enumeration: what a status or a field of a record means."""
    for module in _ENUMERATIONS:
        for kind in vars(module).values():
            is_own = inspect.isclass(kind) and kind.__module__ == module.__name__
            if is_own and issubclass(kind, Enum):
                yield from _enumeration(kind)


def _enumeration(kind: type[Enum]) -> Iterator[str]:
    yield f"/* {kind.__name__}: {inspect.getdoc(kind)} */".replace("``", "")
    yield "enum {"
    for item in kind:
        yield f"  {_MACRO}{_snake(kind.__name__)}_{item.name} = {item.value},"
    yield "};\n"


def _snake(name: str) -> str:
    return "".join(f"_{c}" if c.isupper() and i else c for i, c in enumerate(name)).upper()
