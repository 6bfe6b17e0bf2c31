# SPDX-License-Identifier: Apache-2.0
"""The request to leave SILENT, and what the status answers."""

from __future__ import annotations

from enum import IntEnum
from struct import Struct
from typing import NamedTuple

from safety_island.messages.codec import of_size
from safety_island.messages.wire import HEADER_LE, Time

ARM = "safety_island_msgs/msg/Arm"

_ARM = Struct("<4siIQ")


class ArmResult(IntEnum):
    """What became of the last request; the numbers are those of the status message."""

    NONE = 0
    """No request came."""
    ARMED = 1
    """The island was armed, or left SILENT."""
    REFUSED = 2
    """A cause still stands, or a stop goes on: see the reason."""
    NOT_NEEDED = 3
    """Nothing kept the island from sending commands."""


class Arm(NamedTuple):
    """One request. The same nonce again is the same request: it is sent until it is answered."""

    stamp: Time
    nonce: int
    """Any number from 1 to 2^64 - 1."""


def encode_arm(request: Arm) -> bytes:
    """Return a safety_island_msgs/msg/Arm."""
    return _ARM.pack(HEADER_LE, *request.stamp, request.nonce)


def decode_arm(data: bytes) -> Arm:
    """Return the request of a safety_island_msgs/msg/Arm; DecodeError when it is none."""
    data = of_size(data, _ARM.size, ARM)
    _, sec, nanosec, nonce = _ARM.unpack_from(data)
    return Arm(Time(sec, nanosec), nonce)
