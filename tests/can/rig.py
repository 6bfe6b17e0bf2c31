# SPDX-License-Identifier: Apache-2.0
"""What the tests of CAN output share: commands, a clock, a log, waiting for events."""

from __future__ import annotations

import time
from collections.abc import Callable

from safety_island.can.command import Command
from safety_island.can.encoder import Rejection, Triple, encode
from safety_island.command.mode import OutputMode
from safety_island.platform.interfaces import LogLevel

REFERENCE = Command(0.125, -0.5, 12.25, -1.5, 0.0, True, True, False)
REFERENCE_STAMP_NS = 12_345_000_000
REFERENCE_LINES = ("100#48E80100E05EF8FF", "101#DA2F000024FAFFFF", "102#020B2A0039300000")
LIMIT_S = 10.0


def triple(sequence: int = 42, stamp_ns: int = REFERENCE_STAMP_NS, angle: float = 0.125) -> Triple:
    """Return the frames of a command like the reference."""
    command = REFERENCE._replace(steering_tire_angle=angle)
    frames = encode(command, OutputMode.DDS_AND_CAN, sequence, stamp_ns)
    assert not isinstance(frames, Rejection)
    return frames


def until(condition: Callable[[], bool], limit_s: float = LIMIT_S) -> bool:
    """Wait for a condition; False when it did not come true in time."""
    end = time.monotonic() + limit_s
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.001)
    return True


class FakeClock:
    """A monotonic clock that goes on when it is told to."""

    def __init__(self) -> None:
        self.now_ns = 1_000_000_000

    def __call__(self) -> int:
        return self.now_ns

    def advance(self, seconds: float) -> None:
        self.now_ns += round(seconds * 1e9)


class LogLines:
    """A logger that keeps its lines, each with its level."""

    level = LogLevel.DEBUG
    dropped = 0

    def __init__(self) -> None:
        self.lines: list[str] = []

    def error(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        self.lines.append("ERROR " + text % values)

    def warning(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        self.lines.append("WARN " + text % values)

    def info(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        self.lines.append("INFO " + text % values)

    def debug(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        self.lines.append("DEBUG " + text % values)

    def flush(self, timeout_s: float = 1.0) -> bool:
        return True

    def close(self) -> None:
        pass
