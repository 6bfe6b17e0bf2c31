# SPDX-License-Identifier: Apache-2.0
"""What a message type consists of, independent of any notation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType


class Primitive(StrEnum):
    """Scalar types, by their IDL names."""

    BOOLEAN = "boolean"
    OCTET = "octet"
    INT8 = "int8"
    UINT8 = "uint8"
    INT16 = "int16"
    UINT16 = "uint16"
    INT32 = "int32"
    UINT32 = "uint32"
    INT64 = "int64"
    UINT64 = "uint64"
    FLOAT = "float"
    DOUBLE = "double"


CODES: Mapping[Primitive, str] = MappingProxyType(
    {
        Primitive.BOOLEAN: "?",
        Primitive.OCTET: "B",
        Primitive.INT8: "b",
        Primitive.UINT8: "B",
        Primitive.INT16: "h",
        Primitive.UINT16: "H",
        Primitive.INT32: "i",
        Primitive.UINT32: "I",
        Primitive.INT64: "q",
        Primitive.UINT64: "Q",
        Primitive.FLOAT: "f",
        Primitive.DOUBLE: "d",
    }
)
"""The ``struct`` letter of each primitive."""


@dataclass(frozen=True)
class String:
    """A string; ``bound`` is its greatest length in bytes, None for any."""

    bound: int | None = None


@dataclass(frozen=True)
class Named:
    """Another message, by its ROS name (``pkg/msg/Name``)."""

    name: str


Element = Primitive | String | Named


@dataclass(frozen=True)
class Array:
    """Exactly ``size`` elements."""

    element: Element
    size: int


@dataclass(frozen=True)
class Sequence:
    """Any number of elements, at most ``bound`` when that is given."""

    element: Element
    bound: int | None = None


FieldType = Element | Array | Sequence


@dataclass(frozen=True)
class Field:
    """One member: its name, its type and its default value in a new message."""

    name: str
    type: FieldType
    default: float | int | bool | str | None = None


@dataclass(frozen=True)
class Struct:
    """One message type: ROS name, members in wire order, constants."""

    name: str
    fields: tuple[Field, ...]
    constants: Mapping[str, int] = field(default_factory=dict)
