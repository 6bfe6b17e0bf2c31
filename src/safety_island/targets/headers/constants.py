# SPDX-License-Identifier: Apache-2.0
"""Sizes and enumerations of the kernels' rooms as C constants."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from enum import IntEnum, IntFlag

from safety_island.command.encoding import Encoding
from safety_island.control import limits, status
from safety_island.control.longitudinal_state import LIST_CAPACITY
from safety_island.guard import limit
from safety_island.guard.records import MAX_SPEED_POINTS

_MACRO = "SAFETY_ISLAND_"


def sizes() -> Iterator[str]:
    """Yield a line for each bound of an array."""
    found = {name: value for name, value in vars(limits).items() if name.startswith("MAX_")}
    own = {"LIST_CAPACITY": LIST_CAPACITY, "MAX_SPEED_POINTS": MAX_SPEED_POINTS}
    for name, value in (found | own).items():
        yield f"#define {_MACRO}{name} {value}"


def enumerations() -> Iterator[str]:
    """Yield the lines of each enumeration: what a status or a field of a record means."""
    for kind in (*vars(status).values(), *vars(limit).values(), Encoding):
        if not inspect.isclass(kind) or not issubclass(kind, IntEnum | IntFlag):
            continue
        if kind in (IntEnum, IntFlag):
            continue
        yield f"/* {kind.__name__}: {inspect.getdoc(kind)} */".replace("``", "")
        yield "enum {"
        for item in kind:
            yield f"  {_MACRO}{_snake(kind.__name__)}_{item.name} = {item.value},"
        yield "};\n"


def _snake(name: str) -> str:
    return "".join(f"_{c}" if c.isupper() and i else c for i, c in enumerate(name)).upper()
