# SPDX-License-Identifier: Apache-2.0
"""Random messages of any registered type, as Hypothesis strategies."""

from __future__ import annotations

import math
from typing import Any

from hypothesis import strategies as st

from safety_island.messages import registry
from safety_island.messages.description import (
    Array,
    Element,
    FieldType,
    Named,
    Primitive,
    Sequence,
    String,
)
from safety_island.messages.wire import Time

TEXTS = st.text(st.characters(exclude_characters="\0", codec="utf-8"), max_size=12)
_INTEGERS = {
    Primitive.INT8: (-(2**7), 2**7 - 1),
    Primitive.UINT8: (0, 2**8 - 1),
    Primitive.OCTET: (0, 2**8 - 1),
    Primitive.INT16: (-(2**15), 2**15 - 1),
    Primitive.UINT16: (0, 2**16 - 1),
    Primitive.INT32: (-(2**31), 2**31 - 1),
    Primitive.UINT32: (0, 2**32 - 1),
    Primitive.INT64: (-(2**63), 2**63 - 1),
    Primitive.UINT64: (0, 2**64 - 1),
}


def floats(width: int) -> st.SearchStrategy[float]:
    """Every finite number of this width, both infinities, and one NaN."""
    return st.floats(width=width, allow_nan=False) | st.just(math.nan)  # type: ignore[arg-type]


FLOAT32 = floats(32)
FLOAT64 = floats(64)
TIMES = st.builds(Time, st.integers(-(2**31), 2**31 - 1), st.integers(0, 2**32 - 1))


def messages(name: str) -> st.SearchStrategy[dict[str, Any]]:
    """Messages of one type, as dicts."""
    fields = registry.struct_of(name).fields
    return st.fixed_dictionaries({field.name: _values(field.type) for field in fields})


def _values(kind: FieldType) -> st.SearchStrategy[Any]:
    if isinstance(kind, Array):
        return st.lists(_element(kind.element), min_size=kind.size, max_size=kind.size)
    if isinstance(kind, Sequence):
        return st.lists(_element(kind.element), max_size=4)
    return _element(kind)


def _element(kind: Element) -> st.SearchStrategy[Any]:
    if isinstance(kind, Named):
        return messages(kind.name)
    if isinstance(kind, String):
        return TEXTS
    if kind in _INTEGERS:
        return st.integers(*_INTEGERS[kind])
    if kind is Primitive.BOOLEAN:
        return st.booleans()
    return FLOAT32 if kind is Primitive.FLOAT else FLOAT64
