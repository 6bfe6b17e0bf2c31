# SPDX-License-Identifier: Apache-2.0
"""Message types in one JSON file: what a built island reads instead of parsing the IDL files."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from safety_island.messages.description import (
    Array,
    Element,
    Field,
    FieldType,
    Named,
    Primitive,
    Sequence,
    String,
    Struct,
)

NAME = "compiled.json"
"""Beside this file in a built island."""


def dump(structs: Iterable[Struct]) -> str:
    """Return the text of the file; the same types give the same text."""
    types = {struct.name: _struct_as_json(struct) for struct in structs}
    return json.dumps(types, indent=1, sort_keys=True) + "\n"


def load(text: str) -> dict[str, Struct]:
    """Return the types by ROS name. Raises ValueError or KeyError for another text."""
    return {name: _struct(name, value) for name, value in json.loads(text).items()}


def _struct_as_json(struct: Struct) -> dict[str, Any]:
    fields = [[item.name, _type_as_json(item.type), item.default] for item in struct.fields]
    return {"fields": fields, "constants": dict(struct.constants)}


def _struct(name: str, value: dict[str, Any]) -> Struct:
    fields = tuple(Field(item[0], _type(item[1]), item[2]) for item in value["fields"])
    return Struct(name, fields, value["constants"])


def _type_as_json(kind: FieldType) -> Any:
    if isinstance(kind, Array):
        return ["array", _type_as_json(kind.element), kind.size]
    if isinstance(kind, Sequence):
        return ["sequence", _type_as_json(kind.element), kind.bound]
    if isinstance(kind, String):
        return ["string", kind.bound]
    return kind.name if isinstance(kind, Named) else kind.value


def _type(value: Any) -> FieldType:
    if isinstance(value, str):
        return _element(value)
    if value[0] == "string":
        return String(value[1])
    element = String(value[1][1]) if isinstance(value[1], list) else _element(value[1])
    return Array(element, value[2]) if value[0] == "array" else Sequence(element, value[2])


def _element(word: str) -> Element:
    """A name with a slash is a message."""
    return Named(word) if "/" in word else Primitive(word)
