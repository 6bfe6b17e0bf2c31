# SPDX-License-Identifier: Apache-2.0
"""A logger that keeps its lines in memory."""

from __future__ import annotations

from safety_island.platform.interfaces import Clock, LogConfig
from safety_island.platform.lines import Line, LineLogger


class MemoryLogger(LineLogger):
    """Lines with virtual time, in ``lines``; what comes when it is full is dropped and counted."""

    def __init__(self, clock: Clock, config: LogConfig) -> None:
        super().__init__(clock, config)
        self.lines: list[str] = []
        self._capacity = config.capacity

    def _put(self, line: Line) -> None:
        if len(self.lines) >= self._capacity:
            self.dropped += 1
        else:
            self.lines.append(self.format(line))

    def flush(self, timeout_s: float = 1.0) -> bool:
        """Lines are there as soon as they are logged."""
        return True

    def close(self) -> None:
        """Keep the lines for whoever wants to read them."""
