# SPDX-License-Identifier: Apache-2.0
"""NumPy record types as C structures, with assertions of their layout."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

_C_TYPES = {
    "b1": "bool",
    "i1": "int8_t",
    "u1": "uint8_t",
    "i2": "int16_t",
    "u2": "uint16_t",
    "i4": "int32_t",
    "u4": "uint32_t",
    "i8": "int64_t",
    "u8": "uint64_t",
    "f4": "float",
    "f8": "double",
}


class CRecords:
    """The C structures of a set of record types; a record inside another is one of its own."""

    def __init__(self, names: dict[Any, str], prefix: str) -> None:
        self._names = dict(names)
        self._prefix = prefix
        self._written: list[Any] = []
        self._lines: list[str] = []

    def name(self, dtype: Any) -> str:
        """Return the C type of a record type."""
        return f"struct {self._prefix}{self._names[np.dtype(dtype)]}"

    def add(self, dtype: Any) -> None:
        """Define a record type, after those inside it; a second time does nothing."""
        dtype = np.dtype(dtype)
        if dtype in self._written:
            return
        self._written.append(dtype)
        for field, inner in _inner(dtype):
            self._names.setdefault(inner, f"{self._names[dtype]}_{field}")
            self.add(inner)
        self._lines += [*self._structure(dtype), *self._assertions(dtype), ""]

    def text(self) -> str:
        """Return the definitions."""
        return "\n".join(self._lines)

    def _structure(self, dtype: Any) -> Iterator[str]:
        yield f"{self.name(dtype)} {{"
        for field, kind, _ in fields_of(dtype):
            base, shape = kind.subdtype or (kind, ())
            c_type = self.name(base) if base.names else _C_TYPES[f"{base.kind}{base.itemsize}"]
            yield f"  {c_type} {field}{''.join(f'[{size}]' for size in shape)};"
        yield "};"

    def _assertions(self, dtype: Any) -> Iterator[str]:
        name = self.name(dtype)
        yield f"SAFETY_ISLAND_ASSERT(sizeof({name}) == {dtype.itemsize});"
        for field, _, offset in fields_of(dtype):
            yield f"SAFETY_ISLAND_ASSERT(offsetof({name}, {field}) == {offset});"


def fields_of(dtype: Any) -> Iterator[tuple[str, Any, int]]:
    """Yield name, type and offset of each field, in order."""
    for name in dtype.names:
        kind, offset = dtype.fields[name][:2]
        yield name, kind, offset


def _inner(dtype: Any) -> Iterator[tuple[str, Any]]:
    for name, kind, _ in fields_of(dtype):
        base = (kind.subdtype or (kind, ()))[0]
        if base.names:
            yield name, base
