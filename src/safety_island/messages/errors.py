# SPDX-License-Identifier: Apache-2.0
"""What is said when bytes are no message, or a value does not fit one."""

from __future__ import annotations

from enum import StrEnum

from safety_island.errors import IslandError


class DecodeReason(StrEnum):
    """Why bytes were refused."""

    ENCAPSULATION = "encapsulation"
    """The first four bytes do not announce plain CDR (XCDR1)."""
    TRUNCATED = "truncated"
    """The bytes end inside a field, or a length says that more must come."""
    LENGTH = "length"
    """A string or sequence is longer than its type or the receiver allows."""
    STRING = "string"
    """A string lacks its closing NUL, has another before it, or is not UTF-8."""
    BOOLEAN = "boolean"
    """A boolean is neither 0 nor 1."""
    TRAILING = "trailing"
    """More bytes follow the message than padding explains."""


class DecodeError(IslandError):
    """Bytes that are not a message of the expected type.

    ``reason`` is a DecodeReason, ``type_name`` the ROS name of the type.
    """

    def __init__(self, reason: DecodeReason, type_name: str, detail: str) -> None:
        super().__init__(f"{type_name}: {detail}")
        self.reason = reason
        self.type_name = type_name


class EncodeError(IslandError):
    """A value that its field cannot hold."""


class UnknownTypeError(IslandError):
    """A type name that no IDL file of this package describes."""


class IdlError(IslandError):
    """An IDL file outside the subset that is understood; names file and line."""
