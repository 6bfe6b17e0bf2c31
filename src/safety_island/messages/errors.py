# SPDX-License-Identifier: Apache-2.0
"""What is said when bytes are no message, or a value does not fit one."""

from __future__ import annotations

from safety_island.errors import IslandError
from safety_island.kernel.cdr import DecodeReason


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
