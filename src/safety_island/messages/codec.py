"""Any registered message to CDR bytes and back, driven by its description.

For what is not hot: discovery data, tools, tests. The messages of a tick have codecs of their own
(``inputs``, ``outputs``), which this one is compared with.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, Literal

import numpy as np

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
from safety_island.messages.errors import DecodeError, DecodeReason, EncodeError


def encode(type_name: str, message: Mapping[str, Any]) -> bytes:
    """Return little-endian plain CDR, header included; missing fields take their defaults.

    Arrays and sequences may be lists or NumPy arrays. Raises EncodeError for an unknown field or a
    value that its field cannot hold, UnknownTypeError for the type.
    """
    writer = _Writer()
    try:
        writer.named(type_name, message)
    except (struct.error, TypeError, ValueError, OverflowError) as problem:
        raise EncodeError(f"{type_name}: {problem}") from None
    return bytes(writer.data)


def decode(type_name: str, data: bytes) -> dict[str, Any]:
    """Return the message as nested dicts; arrays of numbers are NumPy arrays.

    Accepts plain CDR of either byte order. Raises DecodeError for everything else; no length in the
    data makes it allocate more than the data themselves justify.
    """
    little = wire.is_little_endian(data, type_name)
    reader = _Reader(data, little, type_name)
    message = reader.named(type_name)
    wire.check_end(data, reader.offset, type_name)
    return message


def default(type_name: str) -> dict[str, Any]:
    """Return a new message with every field at its default (zero, empty, False)."""
    return decode(type_name, encode(type_name, {}))


def to_little_endian(type_name: str, data: bytes) -> bytes:
    """Return the same message as little-endian CDR; DecodeError when it is no message."""
    return encode(type_name, decode(type_name, data))


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


class _Writer:
    def __init__(self) -> None:
        self.data = bytearray(wire.HEADER_LE)

    def named(self, name: str, message: Mapping[str, Any]) -> None:
        fields = registry.struct_of(name).fields
        unknown = set(message) - {field.name for field in fields}
        if unknown:
            raise EncodeError(f"{name} has no field {min(unknown)!r}")
        for field in fields:
            value = message.get(field.name, field.default)
            self.value(field.type, _zero(field.type) if value is None else value)

    def value(self, kind: FieldType, value: Any) -> None:
        if isinstance(kind, Primitive):
            self.align(struct.calcsize(CODES[kind]))
            self.data += struct.pack("<" + CODES[kind], value)
        elif isinstance(kind, String):
            self.string(kind, value)
        elif isinstance(kind, Named):
            self.named(kind.name, value)
        elif isinstance(kind, Array):
            if len(value) != kind.size:
                raise EncodeError(f"an array has {len(value)} elements, expected {kind.size}")
            self.elements(kind.element, value)
        else:
            _check_bound(len(value), kind.bound)
            self.value(Primitive.UINT32, len(value))
            self.elements(kind.element, value)

    def elements(self, element: Element, values: Any) -> None:
        if isinstance(element, Primitive):
            if len(values):
                self.align(struct.calcsize(CODES[element]))
            self.data += struct.pack(f"<{len(values)}{CODES[element]}", *values)
        else:
            for value in values:
                self.value(element, value)

    def string(self, kind: String, value: str) -> None:
        body = wire.string_bytes(value)
        _check_bound(len(body) - 1, kind.bound)
        self.value(Primitive.UINT32, len(body))
        self.data += body

    def align(self, size: int) -> None:
        self.data += bytes(wire.aligned(len(self.data), size) - len(self.data))


def _check_bound(length: int, bound: int | None) -> None:
    if bound is not None and length > bound:
        raise EncodeError(f"length {length} exceeds the bound {bound} of the type")


def _zero(kind: FieldType) -> Any:
    if isinstance(kind, Array):
        return [_zero(kind.element)] * kind.size
    makers: dict[type, Callable[[], Any]] = {Primitive: int, String: str, Named: dict}
    return makers.get(type(kind), list)()


class _Reader:
    def __init__(self, data: bytes, little: bool, type_name: str) -> None:
        self._data = data
        self._order: Literal["<", ">"] = "<" if little else ">"
        self._type_name = type_name
        self.offset = wire.HEADER_SIZE

    def named(self, name: str) -> dict[str, Any]:
        return {field.name: self.value(field.type) for field in registry.struct_of(name).fields}

    def value(self, kind: FieldType) -> Any:
        if isinstance(kind, Primitive):
            return self.primitive(kind)
        if isinstance(kind, String):
            length = self.primitive(Primitive.UINT32)
            self.check_bound(length - 1, kind.bound)
            start = self.take(length)
            return wire.string_body(self._data, start, length, self._type_name)
        if isinstance(kind, Named):
            return self.named(kind.name)
        if isinstance(kind, Array):
            return self.elements(kind.element, kind.size)
        count = self.primitive(Primitive.UINT32)
        self.check_bound(count, kind.bound)
        return self.elements(kind.element, count)

    def primitive(self, kind: Primitive) -> Any:
        code = CODES[kind]
        size = struct.calcsize(code)
        start = self.take(size, size)
        if kind is Primitive.BOOLEAN:
            return wire.read_bool(self._data[start], self._type_name)
        return struct.unpack_from(self._order + code, self._data, start)[0]

    def elements(self, element: Element, count: int) -> Any:
        """Read ``count`` elements; the count is checked against the data before any is made."""
        self.check_room(count * minimum_size(element))
        if isinstance(element, Primitive) and element is not Primitive.BOOLEAN:
            dtype = np.dtype(CODES[element]).newbyteorder(self._order)
            start = self.take(count * dtype.itemsize, dtype.itemsize if count else 1)
            found = np.frombuffer(self._data, dtype, count, start)
            return found.astype(dtype.newbyteorder("="))
        return [self.value(element) for _ in range(count)]

    def take(self, size: int, alignment: int = 1) -> int:
        """Step over ``size`` bytes and return where they start."""
        start = wire.aligned(self.offset, alignment)
        if start + size > len(self._data):
            raise wire.truncated(self._type_name, start + size, len(self._data))
        self.offset = start + size
        return start

    def check_room(self, size: int) -> None:
        if self.offset + size > len(self._data):
            raise wire.truncated(self._type_name, self.offset + size, len(self._data))

    def check_bound(self, length: int, bound: int | None) -> None:
        if bound is not None and length > bound:
            detail = f"length {length} exceeds the bound {bound} of the type"
            raise DecodeError(DecodeReason.LENGTH, self._type_name, detail)
