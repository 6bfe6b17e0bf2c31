# SPDX-License-Identifier: Apache-2.0
"""Types of the message registry as those of the cyclonedds package, which serialize by itself."""

from __future__ import annotations

from functools import cache
from typing import Any

from cyclonedds.idl import make_idl_struct
from cyclonedds.idl import types as _types

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

idl: Any = _types
_PRIMITIVES: dict[Primitive, Any] = {
    Primitive.BOOLEAN: bool,
    Primitive.OCTET: idl.byte,
    Primitive.INT8: idl.int8,
    Primitive.UINT8: idl.uint8,
    Primitive.INT16: idl.int16,
    Primitive.UINT16: idl.uint16,
    Primitive.INT32: idl.int32,
    Primitive.UINT32: idl.uint32,
    Primitive.INT64: idl.int64,
    Primitive.UINT64: idl.uint64,
    Primitive.FLOAT: idl.float32,
    Primitive.DOUBLE: idl.float64,
}


@cache
def cyclone_type(name: str) -> Any:
    """Return the cyclonedds type of a ROS type name; UnknownTypeError when it is not registered."""
    struct = registry.struct_of(name)
    fields = {field.name: _type(field.type) for field in struct.fields}
    return make_idl_struct(name.replace("/", "_"), dds_type_name(name).replace("::", "."), fields)


def _type(kind: FieldType) -> Any:
    if isinstance(kind, Array):
        return idl.array[_element(kind.element), kind.size]
    if isinstance(kind, Sequence):
        element = _element(kind.element)
        return idl.sequence[element] if kind.bound is None else idl.sequence[element, kind.bound]
    return _element(kind)


def _element(kind: Element) -> Any:
    if isinstance(kind, Named):
        return cyclone_type(kind.name)
    if isinstance(kind, String):
        return str if kind.bound is None else idl.bounded_str[kind.bound]
    return _PRIMITIVES[kind]
