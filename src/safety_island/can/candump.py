"""The text forms of can-utils: ``100#48E80100E05EF8FF`` and the lines of ``candump -L``."""

from __future__ import annotations

import re
from typing import NamedTuple

from safety_island.platform.interfaces import CanFrame

MICROSECONDS = 1_000_000
_ERROR_FLAG = 0x2000_0000
_LINE = re.compile(
    r"\((?P<time>\d+\.\d+)\)\s+(?P<channel>\S+)\s+(?P<id>[0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#"
    r"(?:(?P<fd>#[0-9A-Fa-f])(?P<fd_data>(?:[0-9A-Fa-f]{2}){0,64})"
    r"|(?P<remote>[Rr][0-8]?)|(?P<data>(?:[0-9A-Fa-f]{2}){0,8}))(?:\s+[RT])?"
)


class LogEntry(NamedTuple):
    """One frame of a log; ``frame`` is None for what is not a classic data frame with 11 bits."""

    time_s: float
    frame: CanFrame | None
    is_error: bool = False


def format_frame(frame: CanFrame) -> str:
    """Return a frame as ``cansend`` takes it."""
    return f"{frame.arbitration_id:03X}#{frame.data.hex().upper()}"


def format_line(stamp_ns: int, channel: str, frame: CanFrame) -> str:
    """Return a line as ``candump -L`` writes it; the time [ns] is cut to microseconds."""
    seconds, micros = divmod(stamp_ns // 1000, MICROSECONDS)
    return f"({seconds:010d}.{micros:06d}) {channel} {format_frame(frame)}\n"


def parse_line(line: str) -> LogEntry | None:
    """Read a line of ``candump -L``; None when it is not one."""
    match = _LINE.fullmatch(line.strip())
    if match is None:
        return None
    time_s = float(match["time"])
    arbitration_id = int(match["id"], 16)
    if len(match["id"]) > 3 and arbitration_id & _ERROR_FLAG:
        return LogEntry(time_s, None, is_error=True)
    if len(match["id"]) > 3 or match["fd"] or match["remote"]:
        return LogEntry(time_s, None)
    return LogEntry(time_s, CanFrame(arbitration_id, bytes.fromhex(match["data"])))
