# SPDX-License-Identifier: Apache-2.0
"""The message types that are known at run time, by their ROS 2 names."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from safety_island.messages.description import Struct
from safety_island.messages.errors import UnknownTypeError
from safety_island.messages.idl import parse_idl
from safety_island.messages.type_hash import referenced, type_hash
from safety_island.words import did_you_mean


@dataclass(frozen=True)
class MessageType:
    """One type: ROS name, structure, DDS name, ROS 2 type hash (RIHS01)."""

    name: str
    struct: Struct
    dds_name: str
    hash: str


def dds_type_name(name: str) -> str:
    """Return the DDS name of a ROS type: ``pkg/msg/Name`` gives ``pkg::msg::dds_::Name_``.

    Raises UnknownTypeError when the name is not of that form.
    """
    parts = name.split("/")
    if len(parts) != 3 or not all(part.isidentifier() for part in parts):
        raise UnknownTypeError(f"message type {name!r} is not of the form package/msg/Name")
    package, kind, short = parts
    return f"{package}::{kind}::dds_::{short}_"


def ros_type_name(dds_name: str) -> str:
    """Return the ROS name of a DDS type, or the DDS name itself when it is not a ROS type."""
    parts = dds_name.split("::")
    if len(parts) == 4 and parts[2] == "dds_" and parts[3].endswith("_"):
        return f"{parts[0]}/{parts[1]}/{parts[3][:-1]}"
    return dds_name


@cache
def _structs() -> dict[str, Struct]:
    found: dict[str, Struct] = {}
    root = files(__package__).joinpath("idl")
    for package in root.iterdir():
        for item in package.joinpath("msg").iterdir():
            source = f"{package.name}/msg/{item.name}"
            for struct in parse_idl(item.read_text(encoding="utf-8"), source):
                found[struct.name] = struct
    return found


def names() -> list[str]:
    """Return the ROS names of all known types, sorted."""
    return sorted(_structs())


def struct_of(name: str) -> Struct:
    """Return the structure of a type; UnknownTypeError (with the nearest name) when unknown."""
    try:
        return _structs()[name]
    except KeyError:
        hint = did_you_mean(name, _structs())
        raise UnknownTypeError(f"unknown message type {name!r}{hint}") from None


@cache
def lookup(name: str) -> MessageType:
    """Return everything about a type, for example ``lookup("nav_msgs/msg/Odometry")``.

    Raises UnknownTypeError, with the nearest known name, when no IDL file describes it.
    """
    struct = struct_of(name)
    return MessageType(name, struct, dds_type_name(name), type_hash(struct, struct_of))


def known(name: str) -> bool:
    """Say whether an IDL file describes this type."""
    return name in _structs()


def inner_structs(name: str) -> list[Struct]:
    """Return every struct inside a type, at any depth, sorted by name."""
    return referenced(struct_of(name), struct_of)
