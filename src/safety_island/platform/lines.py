# SPDX-License-Identifier: Apache-2.0
"""What a log line looks like, and which lines are held back: shared by all loggers."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import PurePath
from types import CodeType
from typing import NamedTuple

from safety_island.platform.interfaces import Clock, LogConfig, LogLevel


class Line(NamedTuple):
    """One log line before it is written; the time is the wall clock [ns]."""

    time_ns: int
    severity: str
    site: str
    text: str


def format_plain(line: Line) -> str:
    """Return ``[INFO] [seconds] [room/file.py:line] text``, always a single line."""
    seconds, rest = divmod(line.time_ns, 1_000_000_000)
    text = " ".join(line.text.splitlines())
    return f"[{line.severity}] [{seconds}.{rest // 1000:06d}] [{line.site}] {text}\n"


def format_json(line: Line) -> str:
    """Return the line as one JSON object with time [s], level, site and message."""
    document = {
        "time": line.time_ns // 1000 / 1e6,
        "level": line.severity.lower(),
        "site": line.site,
        "message": line.text,
    }
    return json.dumps(document, ensure_ascii=False) + "\n"


class LineLogger:
    """Levels, call sites and throttling; a backend adds ``_put``, which must not wait."""

    def __init__(self, clock: Clock, config: LogConfig) -> None:
        self.level = config.level
        self.dropped = 0
        self.format: Callable[[Line], str] = format_json if config.json else format_plain
        self._clock = clock
        self._throttle_ns = round(config.throttle_s * 1e9)
        self._quiet_until: dict[tuple[CodeType | str, int], int] = {}

    def error(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        """Log what keeps the island from its work."""
        if self.level >= LogLevel.NORMAL:
            self._log("ERROR", text, values, throttled, site)

    def warning(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        """Log what a user should look at."""
        if self.level >= LogLevel.NORMAL:
            self._log("WARN", text, values, throttled, site)

    def info(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        """Log an event of normal operation."""
        if self.level >= LogLevel.NORMAL:
            self._log("INFO", text, values, throttled, site)

    def debug(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        """Log what only a developer wants."""
        if self.level >= LogLevel.DEBUG:
            self._log("DEBUG", text, values, throttled, site)

    def _log(
        self, severity: str, text: str, values: tuple[object, ...], throttled: bool, site: str
    ) -> None:
        frame = sys._getframe(2)
        code, number = frame.f_code, frame.f_lineno
        if throttled and self._is_quiet((site or code, 0 if site else number)):
            return
        place = site or f"{'/'.join(PurePath(code.co_filename).parts[-2:])}:{number}"
        message = text % values if values else text
        self._put(Line(self._clock.wall_ns(), severity, place, message))

    def _is_quiet(self, key: tuple[CodeType | str, int]) -> bool:
        """Whether this call site logged less than an interval ago; else it has logged now."""
        now = self._clock.monotonic_ns()
        if now < self._quiet_until.get(key, now):
            return True
        self._quiet_until[key] = now + self._throttle_ns
        return False

    def _put(self, line: Line) -> None:
        raise NotImplementedError
