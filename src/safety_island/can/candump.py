# SPDX-License-Identifier: Apache-2.0
"""The text forms of can-utils: ``100#48E80100E05EF8FF``, ``candump -L``, ``candump -ta``."""

from __future__ import annotations

import re
from datetime import datetime
from typing import NamedTuple

from safety_island.platform.interfaces import CanFrame

MICROSECONDS = 1_000_000
_ERROR_FLAG = 0x2000_0000
_ID = r"(?P<id>[0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})"
_LOG_LINE = re.compile(
    r"\((?P<time>\d+\.\d+)\)\s+(?P<channel>\S+)\s+" + _ID + r"#"
    r"(?:(?P<fd>#[0-9A-Fa-f])(?P<fd_data>(?:[0-9A-Fa-f]{2}){0,64})"
    r"|(?P<remote>[Rr][0-8]?)(?:_[0-9A-Fa-f])?"
    r"|(?P<data>(?:[0-9A-Fa-f]{2}){0,8})(?:_[0-9A-Fa-f])?)(?:\s+[RT])?"
)
_SCREEN_LINE = re.compile(
    r"\((?P<time>[^)]+)\)\s+(?P<channel>\S+)\s+(?:[RT]X\s+[-B]\s+[-E]\s+)?" + _ID + r"\s+"
    r"\[(?P<length>\d+)\](?P<data>(?:\s+[0-9A-Fa-f]{2})*)(?P<rest>(?:\s.*)?)"
)
"""``candump -ta can0``, also with ``-x`` (direction) and ``-a``; FD frames have two digits."""


class LogEntry(NamedTuple):
    """One frame of a log; ``frame`` is None for what is not a classic data frame with 11 bits."""

    time_s: float
    frame: CanFrame | None
    is_error: bool = False
    channel: str = ""


def format_frame(frame: CanFrame) -> str:
    """Return a frame as ``cansend`` takes it."""
    return f"{frame.arbitration_id:03X}#{frame.data.hex().upper()}"


def format_line(stamp_ns: int, channel: str, frame: CanFrame) -> str:
    """Return a line as ``candump -L`` writes it; the time [ns] is cut to microseconds."""
    seconds, micros = divmod(stamp_ns // 1000, MICROSECONDS)
    return f"({seconds:010d}.{micros:06d}) {channel} {format_frame(frame)}\n"


def parse_line(line: str) -> LogEntry | None:
    """Read a line of ``candump``; None when it is not one, or has no time."""
    text = line.strip()
    if match := _LOG_LINE.fullmatch(text):
        is_other = bool(match["fd"] or match["remote"])
        return _entry(match, float(match["time"]), is_other)
    match = _SCREEN_LINE.fullmatch(text)
    if match is None or (time_s := _time_s(match["time"])) is None:
        return None
    is_remote = "remote request" in match["rest"]
    if not is_remote and len(match["data"].split()) != int(match["length"]):
        return None
    return _entry(match, time_s, is_remote or len(match["length"]) > 1)


def _entry(match: re.Match[str], time_s: float, is_other: bool) -> LogEntry:
    """Return the entry of a line; ``is_other``: a remote frame, or one of CAN FD."""
    channel, arbitration_id = match["channel"], int(match["id"], 16)
    is_long = len(match["id"]) > 3
    if is_long and arbitration_id & _ERROR_FLAG:
        return LogEntry(time_s, None, True, channel)
    if is_long or is_other:
        return LogEntry(time_s, None, False, channel)
    return LogEntry(time_s, CanFrame(arbitration_id, bytes.fromhex(match["data"])), False, channel)


def _time_s(text: str) -> float | None:
    """Read a number of seconds (``-ta``, ``-tz``) or a date (``-tA``)."""
    try:
        return float(text)
    except ValueError:
        pass
    try:
        return datetime.strptime(text, "%Y-%m-%d %H:%M:%S.%f").astimezone().timestamp()
    except ValueError:
        return None
