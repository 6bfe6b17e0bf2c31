# SPDX-License-Identifier: Apache-2.0
"""The C header of the control kernels: sizes, states, records with asserted layout, functions."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any

import numpy as np

from safety_island.kernel.library import PREFIX, SOURCES
from safety_island.kernel.sources import sources_hash
from safety_island.targets.aot.compile import entries
from safety_island.targets.errors import BuildError
from safety_island.targets.headers.constants import enumerations, sizes
from safety_island.targets.headers.records import CRecords

NAME = "safety_island_control.h"

_ROOM = {"points": "MAX_POINTS", "work": "LIST_CAPACITY", "stamps": "MAX_INPUTS"}
"""How many records an argument of that name points to, where it is not one."""
_SCALARS: dict[Any, str] = {float: "double", int: "int64_t"}

_TOP = """\
/* SPDX-License-Identifier: Apache-2.0
 *
 * Kernels of the safety island, generated from the record types of its rooms.
 * One tick: safety_island_lateral_step, safety_island_longitudinal_step, and
 * safety_island_guard_command for what is to be sent. Every function returns a status, keeps all
 * its memory in the records that it is given, and calls nothing but memset
 * and memcpy. Units: m, s, rad and what follows from them.
 */
#ifndef SAFETY_ISLAND_CONTROL_H
#define SAFETY_ISLAND_CONTROL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define SAFETY_ISLAND_ASSERT(condition) static_assert(condition, #condition)
extern "C" {
#else
#define SAFETY_ISLAND_ASSERT(condition) _Static_assert(condition, #condition)
#endif
"""

_END = """
#undef SAFETY_ISLAND_ASSERT
#ifdef __cplusplus
}
#endif
#endif
"""


def control_header() -> str:
    """Return the header; the same sources give the same text."""
    names = record_names()
    records = CRecords(names, PREFIX)
    for dtype in names:
        records.add(dtype)
    functions = [line for entry in entries() for line in _function(entry, records)]
    parts = [_TOP, *sizes(), "", *enumerations(), records.text(), *functions, *_sources()]
    return "\n".join(parts) + _END


def record_names() -> dict[Any, str]:
    """Return every record type that a kernel takes, with its name: that of the constant."""
    found: dict[Any, str] = {}
    for entry in entries():
        constants = sorted(entry.records.items(), reverse=True)
        known = {value: name for name, value in constants if isinstance(value, np.dtype)}
        for dtype in entry.arguments:
            if dtype not in _SCALARS and dtype not in known:
                raise BuildError(f"the kernel '{entry.name}' takes a record type without a name")
            if dtype not in _SCALARS:
                found.setdefault(dtype, known[dtype].lower())
    return found


def record_sizes() -> dict[str, int]:
    """Return the size [bytes] of each record by its C name."""
    return {f"{PREFIX}{name}": dtype.itemsize for dtype, name in record_names().items()}


def _function(entry: Any, records: CRecords) -> Iterator[str]:
    names = inspect.signature(entry.python).parameters
    taken = []
    for name, kind in zip(names, entry.arguments, strict=True):
        if kind in _SCALARS:
            taken.append(f"{_SCALARS[kind]} {name}")
        else:
            room = f" /* [SAFETY_ISLAND_{_ROOM[name]}] */" if name in _ROOM else ""
            taken.append(f"{records.name(kind)} *{name}{room}")
    purpose = (inspect.getdoc(entry.python) or "").partition("\n")[0].replace("``", "")
    yield f"/* {purpose} */"
    yield f"int32_t {PREFIX}{entry.name}(\n    " + ",\n    ".join(taken) + ");\n"


def _sources() -> Iterator[str]:
    yield "/* Hash of the sources that this and the library were made from; both say the same. */"
    yield f'#define SAFETY_ISLAND_SOURCES "{sources_hash()}"'
    yield f"extern const char {SOURCES}[65];"
