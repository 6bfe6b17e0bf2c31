# SPDX-License-Identifier: Apache-2.0
"""Types of the message registry as CycloneDDS's own C descriptors, made at run time.

A descriptor is a small program (``dds/ddsc/dds_opcodes.h``) by which the library checks serialized
samples, on writing and on receipt, and swaps the bytes of big-endian ones. It holds no type
information, so none is announced: peers match by the name of the type, as with every ROS 2 release
up to Jazzy. Announced, it crashes CycloneDDS 0.10, and DDS would match a type by its members,
whatever its name.

No generated code: generated packages would collide with a ROS installation, and their names are not
mangled as ROS 2 mangles them.
"""

from __future__ import annotations

import ctypes as ct
from functools import cache
from typing import Any

from safety_island.dds.library.layouts import Descriptor
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
from safety_island.messages.registry import dds_type_name

_PRIMITIVES: dict[Primitive, Any] = {
    Primitive.BOOLEAN: ct.c_bool,
    Primitive.OCTET: ct.c_uint8,
    Primitive.INT8: ct.c_int8,
    Primitive.UINT8: ct.c_uint8,
    Primitive.INT16: ct.c_int16,
    Primitive.UINT16: ct.c_uint16,
    Primitive.INT32: ct.c_int32,
    Primitive.UINT32: ct.c_uint32,
    Primitive.INT64: ct.c_int64,
    Primitive.UINT64: ct.c_uint64,
    Primitive.FLOAT: ct.c_float,
    Primitive.DOUBLE: ct.c_double,
}
_RETURN, _ADDRESS = 0, 0x01 << 24
_OF_SIZE = {1: 0x01, 2: 0x02, 4: 0x03, 8: 0x04}
_STRING, _BOUNDED_STRING, _SEQUENCE, _ARRAY, _STRUCT = 0x05, 0x06, 0x07, 0x08, 0x0A
_BOUNDED_SEQUENCE, _EXTERNAL, _BOOLEAN = 0x0B, 0x0D, 0x0E
_XCDR1 = 1 << 0


class _Sequence(ct.Structure):
    """``dds_sequence_t`` of ddsc/dds_public_impl.h."""

    _fields_ = (
        ("maximum", ct.c_uint32),
        ("length", ct.c_uint32),
        ("buffer", ct.c_void_p),
        ("release", ct.c_bool),
    )


def descriptor_of(name: str) -> Descriptor:
    """Return the descriptor of a ROS type that is registered, else the opaque one."""
    return _described(name) if registry.known(name) else opaque_descriptor(name)


def opaque_descriptor(name: str) -> Descriptor:
    """Return a descriptor with the name of a ROS type that says nothing of its content.

    Samples then pass through unchecked, and a big-endian one cannot be told from others.
    """
    return _descriptor(name, ct.c_uint8, 2, [_ADDRESS | _OF_SIZE[1] << 16, 0, _RETURN])


def type_hash_data(name: str) -> bytes:
    """Return what ROS 2 expects in the user data of an endpoint; empty for an unknown type."""
    return f"typehash={registry.lookup(name).hash};".encode() if registry.known(name) else b""


@cache
def _described(name: str) -> Descriptor:
    program = _Program()
    program.routine(name)
    return _descriptor(name, _memory_of_struct(name), program.count, program.words)


def _descriptor(name: str, memory: Any, count: int, words: list[int]) -> Descriptor:
    return Descriptor(
        size=ct.sizeof(memory),
        alignment=ct.alignment(memory),
        type_name=dds_type_name(name).encode("ascii"),
        operation_count=count,
        operations=(ct.c_uint32 * len(words))(*words),
        xml=b"",
        representations=_XCDR1,
    )


class _Program:
    """The operations of a struct, and behind them those of every struct inside it."""

    def __init__(self) -> None:
        self.words: list[int] = []
        self.count = 0
        """Operations so far; each is one word or several."""

    def routine(self, name: str) -> None:
        """Append the operations of a struct, each inner one following the outer one."""
        memory = _memory_of_struct(name)
        calls: list[tuple[int, int, Named]] = []
        for field in registry.struct_of(name).fields:
            self._field(field.type, getattr(memory, field.name).offset, calls)
        self._append(_RETURN)
        for start, word, called in calls:
            self.words[word] |= len(self.words) - start
            self.routine(called.name)

    def _append(self, *words: int) -> None:
        self.words += words
        self.count += 1

    def _field(self, kind: FieldType, offset: int, calls: list[tuple[int, int, Named]]) -> None:
        """Append the operation of a field; a struct's jump is filled in when its place is known."""
        start = len(self.words)
        words = _operation(kind, offset)
        element = kind.element if isinstance(kind, (Array, Sequence)) else kind
        if isinstance(element, Named):
            jump = 3 if isinstance(kind, Array) else len(words)
            words.insert(jump, (len(words) + 1) << 16)
            calls.append((start, start + jump, element))
        self._append(*words)


def _operation(kind: FieldType, offset: int) -> list[int]:
    """Return the words of a field's operation, without the jump to the routine of a struct."""
    if isinstance(kind, Array):
        operation = _ADDRESS | _ARRAY << 16 | _code(kind.element) << 8
        behind = [0, *_bound(kind.element)] if _bound(kind.element) else _size(kind.element)
        return [operation, offset, kind.size, *behind]
    if isinstance(kind, Sequence):
        code = _SEQUENCE if kind.bound is None else _BOUNDED_SEQUENCE
        limit = [] if kind.bound is None else [kind.bound]
        operation = _ADDRESS | code << 16 | _code(kind.element) << 8
        return [operation, offset, *limit, *_bound(kind.element), *_size(kind.element)]
    code = _EXTERNAL if isinstance(kind, Named) else _code(kind)
    return [_ADDRESS | code << 16, offset, *_bound(kind)]


def _code(kind: Element) -> int:
    if isinstance(kind, Named):
        return _STRUCT
    if isinstance(kind, String):
        return _STRING if kind.bound is None else _BOUNDED_STRING
    return _BOOLEAN if kind is Primitive.BOOLEAN else _OF_SIZE[ct.sizeof(_PRIMITIVES[kind])]


def _bound(kind: Element) -> list[int]:
    """Return the room of a bounded string, its end included; nothing for other types."""
    bounded = isinstance(kind, String) and kind.bound is not None
    return [ct.sizeof(_memory(kind))] if bounded else []


def _size(kind: Element) -> list[int]:
    """Return the size of a struct as an element; nothing for other types."""
    return [ct.sizeof(_memory(kind))] if isinstance(kind, Named) else []


@cache
def _memory_of_struct(name: str) -> Any:
    """Return the C struct of a type, as ctypes lays it out."""
    fields = [(field.name, _memory(field.type)) for field in registry.struct_of(name).fields]
    return type(name.replace("/", "_"), (ct.Structure,), {"_fields_": fields})


def _memory(kind: FieldType) -> Any:
    if isinstance(kind, Array):
        return _memory(kind.element) * kind.size
    if isinstance(kind, Sequence):
        return _Sequence
    if isinstance(kind, Named):
        return _memory_of_struct(kind.name)
    if isinstance(kind, String):
        return ct.c_char_p if kind.bound is None else ct.c_char * (kind.bound + 1)
    return _PRIMITIVES[kind]
