# SPDX-License-Identifier: Apache-2.0
"""The trajectory: a zero-copy view of the bytes, a copy in one stroke, and the encoder."""

from __future__ import annotations

from struct import Struct, error
from typing import Any, NamedTuple

import numpy as np

from safety_island.messages import wire
from safety_island.messages.errors import DecodeError, DecodeReason
from safety_island.messages.framed import decode_stamp, little_endian
from safety_island.messages.inputs import string_prefix
from safety_island.messages.points import POINT, POINT_HEAD, TIME_SIZE, Points
from safety_island.messages.strings import LeadingStrings
from safety_island.messages.wire import HEADER_LE, Time

TRAJECTORY = "autoware_planning_msgs/msg/Trajectory"
_U32 = Struct("<I")
_FRAME_AT = wire.HEADER_SIZE + 8
_NO_TIME = bytes(TIME_SIZE)
_TIME = Struct("<iI")
_POINT_SIZE = POINT.itemsize
_new = tuple.__new__


class Trajectory(NamedTuple):
    """A planned path in ``frame_id``; ``points`` are POINT (or POINT_HEAD) records."""

    stamp: Time
    frame_id: str
    points: Points
    first_time: Time
    """time_from_start of the first point; each record holds the one of the point after it."""


_Layout = tuple[Time, str, int, Time, int]
"""Stamp, frame, number of points, time of the first, and the place of its ``position.x``."""


def decode_trajectory(data: bytes, out: Points | None = None) -> Trajectory:
    """Return a trajectory whose points are POINT records in aligned memory of their own.

    The points are copied in one stroke: into the first records of ``out`` (a C-contiguous POINT
    array) when it is given, else into a new array. The last record's ``sec`` and ``nanosec`` are 0.
    Raises DecodeError when the data are no trajectory or ``out`` is too small; ``out`` is then
    untouched.
    """
    data = little_endian(data, TRAJECTORY)
    stamp, frame_id, count, first_time, start = _read_head(data)
    if out is None:
        out = np.empty(count, POINT)
    elif count > len(out):
        detail = f"{count} points, at most {len(out)} are taken"
        raise DecodeError(DecodeReason.LENGTH, TRAJECTORY, detail)
    if count:
        size = count * _POINT_SIZE - TIME_SIZE
        memory = _memory_of(out)
        memory[:size] = memoryview(data)[start : start + size]
        memory[size : size + TIME_SIZE] = _NO_TIME
    return _new(Trajectory, (stamp, frame_id, out[:count], first_time))


_known: list[tuple[Points, memoryview[Any]]] = []


def _memory_of(out: Points) -> memoryview[Any]:
    """Return the bytes of an array; a view costs more than a copy, so the last two are kept."""
    for points, memory in _known:
        if points is out:
            return memory
    del _known[:-1]
    memory = out.data.cast("B")
    _known.append((out, memory))
    return memory


def view_trajectory(data: bytes) -> Trajectory:
    """Return a trajectory whose points are a read-only view of ``data``: nothing is copied.

    Records are POINT_HEAD, 88 bytes apart and not aligned: fit for NumPy, not for a kernel.
    Raises DecodeError when the data are no trajectory.
    """
    data = little_endian(data, TRAJECTORY)
    stamp, frame_id, count, first_time, start = _read_head(data)
    points: Points = np.empty(0, POINT_HEAD)
    if count:
        points = np.ndarray((count,), POINT_HEAD, data, start, (_POINT_SIZE,))
    points.flags.writeable = False
    return Trajectory(stamp, frame_id, points, first_time)


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


class _Head:
    """What stands before the points; that of a frame like the one before is read in one stroke."""

    def __init__(self) -> None:
        self._frame = LeadingStrings(TRAJECTORY, 1)
        self._known: bytes | None = None
        self._frame_id = ""
        self._end = self._start = 0
        self._whole = _TIME

    def read(self, data: bytes) -> _Layout:
        """Return the layout of little-endian data. Raises DecodeError."""
        if data[_FRAME_AT : self._end] == self._known and len(data) > self._start:
            sec, nanosec, count, first_sec, first_nanosec = self._whole.unpack_from(data)
            if count:
                wire.check_end(data, self._start + count * _POINT_SIZE - TIME_SIZE, TRAJECTORY)
                first = _new(Time, (first_sec, first_nanosec))
                return _new(Time, (sec, nanosec)), self._frame_id, count, first, self._start
        return self._read_anew(data)

    def _read_anew(self, data: bytes) -> _Layout:
        stamp = decode_stamp(data, TRAJECTORY)
        end = self._frame.read(data)
        (frame_id,) = self._frame.texts
        count_at = wire.aligned(end, 4)
        try:
            (count,) = _U32.unpack_from(data, count_at)
            if count == 0:
                wire.check_end(data, count_at + 4, TRAJECTORY)
                return stamp, frame_id, 0, Time(), 0
            first_time = Time(*_TIME.unpack_from(data, count_at + 4))
        except error:
            raise wire.truncated(TRAJECTORY, count_at + 12, len(data)) from None
        start = wire.aligned(count_at + 12, 8)
        wire.check_end(data, start + count * _POINT_SIZE - TIME_SIZE, TRAJECTORY)
        self._known, self._frame_id = bytes(data[_FRAME_AT:end]), frame_id
        self._end, self._start = end, start
        self._whole = Struct(f"<{wire.HEADER_SIZE}xiI{count_at - _FRAME_AT}xIiI")
        return stamp, frame_id, count, first_time, start


_read_head = _Head().read
