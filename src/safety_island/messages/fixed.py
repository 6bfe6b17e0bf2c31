# SPDX-License-Identifier: Apache-2.0
"""Messages of fixed size as records: the type is the C struct, its bytes are the CDR body.

Derived from the registry, so that a layout stands in one place, the IDL file. To set a field of
such a record is to write its bytes; a kernel can do that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial
from operator import itemgetter
from struct import Struct
from typing import Any

import numpy as np
import numpy.typing as npt

from safety_island.kernel.cdr import HEADER_SIZE
from safety_island.kernel.records import Records, record
from safety_island.messages import wire
from safety_island.messages.description import CODES, Array, Field, Named, Primitive
from safety_island.messages.errors import IdlError
from safety_island.messages.registry import struct_of
from safety_island.messages.wire import HEADER_LE

_WIDE = {"L": "Q", "l": "q"}
"""Letter of NumPy -> letter of ``struct`` for the same size, where they differ."""
_WIDEST = 8
"""The strictest alignment of CDR [bytes]."""


@cache
def record_type(type_name: str) -> Any:
    """Return the little-endian record type of a message.

    Raises IdlError for a message without fixed size, and for one that C and CDR lay out differently
    (C fills a struct up to its alignment, CDR does not).
    """
    found = record([_column(type_name, field) for field in struct_of(type_name).fields])
    end = 0
    for at, kind in _leaves(found):
        if at != end + -end % kind.base.alignment:
            raise IdlError(f"{type_name}: C and CDR would lay out its fields differently")
        end = at + kind.itemsize
    return found


def body_size(kind: Any) -> int:
    """Return the size [bytes] of a record in CDR, where nothing follows the last field."""
    *_, (at, last) = _leaves(kind)
    return at + int(last.itemsize)


def layout(kind: Any) -> str:
    """Return the letters of ``struct`` for a record type, without those for byte order.

    A message within it is written field by field, an array of numbers as its bytes, what lies
    between two fields as zeros.
    """
    letters, end = "", 0
    for at, leaf in _leaves(kind):
        letters += f"{at - end}x" if at > end else ""
        letters += f"{leaf.itemsize}s" if leaf.subdtype else letter(leaf)
        end = at + leaf.itemsize
    return letters


def check_flags(data: bytes, kind: Any, type_name: str) -> None:
    """Raise DecodeError unless every boolean of a whole message is 0 or 1."""
    for place in _flags(kind):
        wire.read_bool(data[HEADER_SIZE + place], type_name)


@cache
def _flags(kind: Any) -> list[int]:
    return [at for at, leaf in _leaves(kind) if leaf.kind == "b"]


def _leaves(kind: Any, start: int = 0) -> Iterator[tuple[int, Any]]:
    """Yield place and type of each number, and of each array of numbers, in order."""
    base, shape = kind.subdtype or (kind, ())
    if not base.names:
        yield start, kind
        return
    for index in range(shape[0] if shape else 1):
        for name in base.names:
            inner, at = base.fields[name][:2]
            yield from _leaves(inner, start + index * base.itemsize + at)


def reader(record: npt.NDArray[Any], *names: str) -> Callable[[], tuple[Any, ...]]:
    """Return a function that reads scalar fields of a record of shape (1,), in this order, at once.

    It takes a fifth of the time that NumPy takes. The record must stay where it is in memory.
    """
    fields: Any = record.dtype.fields
    letters, end = "=", 0
    in_memory = sorted(names, key=lambda name: int(fields[name][1]))
    for name in in_memory:
        column, at = fields[name][:2]
        letters += f"{at - end}x{letter(column)}"
        end = at + column.itemsize
    read = partial(Struct(letters).unpack_from, record.view(np.uint8).data)
    if in_memory == list(names):
        return read
    order = itemgetter(*(in_memory.index(name) for name in names))
    return lambda: order(read())


def letter(column: Any) -> str:
    """Return the letter of ``struct``, in standard sizes, for a scalar type of NumPy."""
    return _WIDE.get(str(column.char), str(column.char))


class FixedMessage:
    """Memory of one message: its header, then ``body``, a (1,) record on an 8-byte boundary."""

    def __init__(self, type_name: str) -> None:
        kind = record_type(type_name)
        start = _WIDEST - HEADER_SIZE
        words = -(-(_WIDEST + kind.itemsize) // _WIDEST)
        memory = np.zeros(words, np.uint64).view(np.uint8)
        memory[start:_WIDEST] = tuple(HEADER_LE)
        self.body: Records = memory[_WIDEST : _WIDEST + kind.itemsize].view(kind)
        self._data = memory[start : _WIDEST + body_size(kind)].data

    def to_bytes(self) -> bytes:
        """Return the message as it is now."""
        return self._data.tobytes()


def _column(type_name: str, field: Field) -> Any:
    kind = field.type
    if isinstance(kind, Array):
        return field.name, _element(type_name, field, kind.element), (kind.size,)
    return field.name, _element(type_name, field, kind)


def _element(type_name: str, field: Field, kind: Any) -> Any:
    if isinstance(kind, Named):
        return record_type(kind.name)
    if isinstance(kind, Primitive):
        return np.dtype(CODES[kind]).newbyteorder("<")
    raise IdlError(f"{type_name}.{field.name}: found {type(kind).__name__}, expected fixed size")
