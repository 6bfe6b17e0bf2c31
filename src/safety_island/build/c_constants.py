# SPDX-License-Identifier: Apache-2.0
"""Sizes and enumerations of the kernels as C constants."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from enum import IntEnum

from safety_island.control import limits, status
from safety_island.control.longitudinal_state import LIST_CAPACITY
from safety_island.input_gate.clock.records import MAX_INPUTS
from safety_island.kernel.cdr import DecodeReason

_MACRO = "SAFETY_ISLAND_"


def sizes() -> Iterator[str]:
    """Yield a line for each bound of an array."""
    found = {name: value for name, value in vars(limits).items() if name.startswith("MAX_")}
    for name, value in (found | {"LIST_CAPACITY": LIST_CAPACITY, "MAX_INPUTS": MAX_INPUTS}).items():
        yield f"#define {_MACRO}{name} {value}"


def enumerations() -> Iterator[str]:
    """Yield the lines of each enumeration: what a status or a field of a record means."""
    for kind in (*vars(status).values(), DecodeReason):
        if not inspect.isclass(kind) or not issubclass(kind, IntEnum) or kind is IntEnum:
            continue
        yield f"/* {kind.__name__}: {inspect.getdoc(kind)} */".replace("``", "")
        yield "enum {"
        for item in kind:
            yield f"  {_MACRO}{_snake(kind.__name__)}_{item.name} = {item.value},"
        yield "};\n"


def _snake(name: str) -> str:
    return "".join(f"_{c}" if c.isupper() and i else c for i, c in enumerate(name)).upper()
