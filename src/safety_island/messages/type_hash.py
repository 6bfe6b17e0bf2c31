# SPDX-License-Identifier: Apache-2.0
"""The ROS 2 type hash (RIHS01) of a message, as REP 2011 and rosidl define it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from typing import Any

from safety_island.messages.description import (
    Array,
    Element,
    FieldType,
    Named,
    Primitive,
    Sequence,
    String,
    Struct,
)

_NESTED = 1
_STRING = 17
_BOUNDED_STRING = 21
_ARRAY = 48
_BOUNDED_SEQUENCE = 96
_UNBOUNDED_SEQUENCE = 144
_IDS = {
    Primitive.INT8: 2,
    Primitive.UINT8: 3,
    Primitive.INT16: 4,
    Primitive.UINT16: 5,
    Primitive.INT32: 6,
    Primitive.UINT32: 7,
    Primitive.INT64: 8,
    Primitive.UINT64: 9,
    Primitive.FLOAT: 10,
    Primitive.DOUBLE: 11,
    Primitive.BOOLEAN: 15,
    Primitive.OCTET: 16,
}
"""Numbers of type_description_interfaces/msg/FieldType."""


def referenced(struct: Struct, lookup: Callable[[str], Struct]) -> list[Struct]:
    """Return every struct inside ``struct``, at any depth, sorted by name."""
    found: dict[str, Struct] = {}
    pending = [struct]
    while pending:
        for item in pending.pop().fields:
            element = _element(item.type)
            if isinstance(element, Named) and element.name not in found:
                found[element.name] = lookup(element.name)
                pending.append(found[element.name])
    return [found[name] for name in sorted(found)]


def type_hash(struct: Struct, lookup: Callable[[str], Struct]) -> str:
    """Return ``RIHS01_`` and 64 hexadecimal digits; ``lookup`` gives the inner structs."""
    description = {
        "type_description": _describe(struct),
        "referenced_type_descriptions": [_describe(s) for s in referenced(struct, lookup)],
    }
    digest = hashlib.sha256(json.dumps(description).encode("ascii")).hexdigest()
    return f"RIHS01_{digest}"


def _element(kind: FieldType) -> Element:
    return kind.element if isinstance(kind, (Array, Sequence)) else kind


def _describe(struct: Struct) -> dict[str, Any]:
    fields = [{"name": item.name, "type": _describe_type(item.type)} for item in struct.fields]
    return {"type_name": struct.name, "fields": fields}


def _describe_type(kind: FieldType) -> dict[str, Any]:
    number, string_capacity, nested = _describe_element(_element(kind))
    capacity = 0
    if isinstance(kind, Array):
        number, capacity = number + _ARRAY, kind.size
    elif isinstance(kind, Sequence) and kind.bound is not None:
        number, capacity = number + _BOUNDED_SEQUENCE, kind.bound
    elif isinstance(kind, Sequence):
        number += _UNBOUNDED_SEQUENCE
    return {
        "type_id": number,
        "capacity": capacity,
        "string_capacity": string_capacity,
        "nested_type_name": nested,
    }


def _describe_element(element: Element) -> tuple[int, int, str]:
    if isinstance(element, Named):
        return _NESTED, 0, element.name
    if isinstance(element, String):
        return (_STRING, 0, "") if element.bound is None else (_BOUNDED_STRING, element.bound, "")
    return _IDS[element], 0, ""
