# SPDX-License-Identifier: Apache-2.0
"""Plain CDR of either byte order to values of a described type, bounded against hostile lengths."""

from __future__ import annotations

import struct
from functools import cache
from typing import Any, Literal

import numpy as np

from safety_island.kernel.cdr import HEADER_SIZE, DecodeReason
from safety_island.messages import registry, wire
from safety_island.messages.description import (
    CODES,
    Array,
    Element,
    FieldType,
    Named,
    Primitive,
    Sequence,
    String,
)
from safety_island.messages.errors import DecodeError


@cache
def minimum_size(kind: FieldType) -> int:
    """Fewest bytes [1] that one value of this type can take, alignment left aside."""
    if isinstance(kind, Primitive):
        return struct.calcsize(CODES[kind])
    if isinstance(kind, (String, Sequence)):
        return 4
    if isinstance(kind, Array):
        return kind.size * minimum_size(kind.element)
    return sum(minimum_size(field.type) for field in registry.struct_of(kind.name).fields)


class Reader:
    """Steps through the bytes of one message; ``offset`` is the next byte to read."""

    def __init__(self, data: bytes, little: bool, type_name: str) -> None:
        self._data = data
        self._order: Literal["<", ">"] = "<" if little else ">"
        self._type_name = type_name
        self.offset = HEADER_SIZE

    def named(self, name: str) -> dict[str, Any]:
        """Read a message of the type ``name``; DecodeError when the data are none."""
        return {field.name: self.value(field.type) for field in registry.struct_of(name).fields}

    def value(self, kind: FieldType) -> Any:
        """Read one value."""
        if isinstance(kind, Primitive):
            return self._primitive(kind)
        if isinstance(kind, String):
            length = self._primitive(Primitive.UINT32)
            self._check_bound(length - 1, kind.bound)
            start = self._take(length)
            return wire.string_body(self._data, start, length, self._type_name)
        if isinstance(kind, Named):
            return self.named(kind.name)
        if isinstance(kind, Array):
            return self._elements(kind.element, kind.size)
        count = self._primitive(Primitive.UINT32)
        self._check_bound(count, kind.bound)
        return self._elements(kind.element, count)

    def _primitive(self, kind: Primitive) -> Any:
        code = CODES[kind]
        size = struct.calcsize(code)
        start = self._take(size, size)
        if kind is Primitive.BOOLEAN:
            return wire.read_bool(self._data[start], self._type_name)
        return struct.unpack_from(self._order + code, self._data, start)[0]

    def _elements(self, element: Element, count: int) -> Any:
        """Read ``count`` elements; the count is checked against the data before any is made."""
        self._check_room(count * minimum_size(element))
        if isinstance(element, Primitive) and element is not Primitive.BOOLEAN:
            dtype = np.dtype(CODES[element]).newbyteorder(self._order)
            start = self._take(count * dtype.itemsize, dtype.itemsize if count else 1)
            found = np.frombuffer(self._data, dtype, count, start)
            return found.astype(dtype.newbyteorder("="))
        return [self.value(element) for _ in range(count)]

    def _take(self, size: int, alignment: int = 1) -> int:
        """Step over ``size`` bytes and return where they start."""
        start = wire.aligned(self.offset, alignment)
        if start + size > len(self._data):
            raise wire.truncated(self._type_name, start + size, len(self._data))
        self.offset = start + size
        return start

    def _check_room(self, size: int) -> None:
        if self.offset + size > len(self._data):
            raise wire.truncated(self._type_name, self.offset + size, len(self._data))

    def _check_bound(self, length: int, bound: int | None) -> None:
        if bound is not None and length > bound:
            detail = f"length {length} exceeds the bound {bound} of the type"
            raise DecodeError(DecodeReason.LENGTH, self._type_name, detail)
