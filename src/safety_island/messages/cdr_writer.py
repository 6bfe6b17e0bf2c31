# SPDX-License-Identifier: Apache-2.0
"""Values of a described type to little-endian plain CDR."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from typing import Any

from safety_island.messages import registry, wire
from safety_island.messages.description import (
    CODES,
    Array,
    Element,
    FieldType,
    Named,
    Primitive,
    String,
)
from safety_island.messages.errors import EncodeError


class Writer:
    """Collects the bytes of one message in ``data``, header included."""

    def __init__(self) -> None:
        self.data = bytearray(wire.HEADER_LE)

    def named(self, name: str, message: Mapping[str, Any]) -> None:
        """Append a message of the type ``name``; EncodeError for a field that it does not have."""
        fields = registry.struct_of(name).fields
        unknown = set(message) - {field.name for field in fields}
        if unknown:
            raise EncodeError(f"{name} has no field {min(unknown)!r}")
        for field in fields:
            value = message.get(field.name, field.default)
            self.value(field.type, _zero(field.type) if value is None else value)

    def value(self, kind: FieldType, value: Any) -> None:
        """Append one value, aligned as its type asks."""
        if isinstance(kind, Primitive):
            self._align(struct.calcsize(CODES[kind]))
            self.data += struct.pack("<" + CODES[kind], value)
        elif isinstance(kind, String):
            self._string(kind, value)
        elif isinstance(kind, Named):
            self.named(kind.name, value)
        elif isinstance(kind, Array):
            if len(value) != kind.size:
                raise EncodeError(f"an array has {len(value)} elements, expected {kind.size}")
            self._elements(kind.element, value)
        else:
            _check_bound(len(value), kind.bound)
            self.value(Primitive.UINT32, len(value))
            self._elements(kind.element, value)

    def _elements(self, element: Element, values: Any) -> None:
        if isinstance(element, Primitive):
            if len(values):
                self._align(struct.calcsize(CODES[element]))
            self.data += struct.pack(f"<{len(values)}{CODES[element]}", *values)
        else:
            for value in values:
                self.value(element, value)

    def _string(self, kind: String, value: str) -> None:
        body = wire.string_bytes(value)
        _check_bound(len(body) - 1, kind.bound)
        self.value(Primitive.UINT32, len(body))
        self.data += body

    def _align(self, size: int) -> None:
        self.data += bytes(wire.aligned(len(self.data), size) - len(self.data))


def _check_bound(length: int, bound: int | None) -> None:
    if bound is not None and length > bound:
        raise EncodeError(f"length {length} exceeds the bound {bound} of the type")


def _zero(kind: FieldType) -> Any:
    if isinstance(kind, Array):
        return [_zero(kind.element)] * kind.size
    makers: dict[type, Callable[[], Any]] = {Primitive: int, String: str, Named: dict}
    return makers.get(type(kind), list)()
