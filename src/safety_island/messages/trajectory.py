# SPDX-License-Identifier: Apache-2.0
"""The trajectory: its decoder and its encoder."""

from __future__ import annotations

from struct import Struct
from typing import NamedTuple

import numpy as np

from safety_island.messages import wire
from safety_island.messages.decoders import decoders
from safety_island.messages.inputs import string_prefix
from safety_island.messages.points import POINT, TIME_SIZE, Points
from safety_island.messages.wire import HEADER_LE, Time

TRAJECTORY = "autoware_planning_msgs/msg/Trajectory"
_U32 = Struct("<I")
_TIME = Struct("<iI")


class Trajectory(NamedTuple):
    """A planned path in ``frame_id``; ``points`` are POINT records."""

    stamp: Time
    frame_id: str
    points: Points
    first_time: Time
    """time_from_start of the first point; each record holds the one of the point after it."""


def decode_trajectory(data: bytes, out: Points | None = None) -> Trajectory:
    """Return a trajectory whose points are POINT records in aligned memory of their own.

    They are those of ``out`` (a C-contiguous POINT array) when it is given, else of a new array.
    The last record's ``sec`` and ``nanosec`` are 0.
    Raises DecodeError when the data are no trajectory or ``out`` is too small; ``out`` is then
    untouched.
    """
    found = decoders().trajectory(data, out, TRAJECTORY)
    sec, nanosec, frame_id, points, first_sec, first_nanosec = found
    return Trajectory(Time(sec, nanosec), frame_id, points, Time(first_sec, first_nanosec))


def encode_trajectory(
    stamp: Time, frame_id: str, points: Points, first_time: Time | None = None
) -> bytes:
    """Return an autoware_planning_msgs/msg/Trajectory of POINT records.

    ``first_time`` is the time_from_start of the first point (zero when not given).
    """
    prefix, end = string_prefix(frame_id)
    count_at = wire.aligned(end, 4)
    head = HEADER_LE + _TIME.pack(*stamp) + prefix + bytes(count_at - end)
    head += _U32.pack(len(points))
    if not len(points):
        return head
    head += _TIME.pack(*(first_time or Time()))
    padding = bytes(wire.aligned(len(head), 8) - len(head))
    body = np.ascontiguousarray(points, POINT).tobytes()
    return head + padding + body[:-TIME_SIZE]
