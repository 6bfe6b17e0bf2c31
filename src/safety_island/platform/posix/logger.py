# SPDX-License-Identifier: Apache-2.0
"""A logger whose lines a thread of its own writes, so that a slow terminal never delays a tick."""

from __future__ import annotations

import os
import threading
from contextlib import suppress
from queue import SimpleQueue

from safety_island.platform.interfaces import Clock, LogConfig
from safety_island.platform.lines import Line, LineLogger

STANDARD_ERROR = 2
CLOSE_LIMIT_S = 0.3
"""A sink that does not take its lines must not delay the end of the process."""


class PosixLogger(LineLogger):
    """A bounded queue, and one thread that sleeps until a line is put into it.

    ``descriptor``: the file descriptor that lines are written to.
    """

    def __init__(self, clock: Clock, config: LogConfig, descriptor: int = STANDARD_ERROR) -> None:
        super().__init__(clock, config)
        self._capacity = config.capacity
        self._descriptor = descriptor
        self._queue: SimpleQueue[Line | threading.Event | None] = SimpleQueue()
        self._told = 0
        self._writer = threading.Thread(target=self._write_lines, name="log", daemon=True)
        self._writer.start()

    def _put(self, line: Line) -> None:
        if self._queue.qsize() >= self._capacity:
            self.dropped += 1
        else:
            self._queue.put(line)

    def _write_lines(self) -> None:
        while (item := self._queue.get()) is not None:
            if isinstance(item, threading.Event):
                item.set()
            else:
                self._write(item)

    def _write(self, line: Line) -> None:
        text = self.format(line)
        if self.dropped > self._told:
            note = f"{self.dropped - self._told} log lines were dropped: they came too fast"
            self._told = self.dropped
            text += self.format(Line(line.time_ns, "WARN", "platform/logger", note))
        data = text.encode(errors="backslashreplace")
        try:
            while data:
                data = data[os.write(self._descriptor, data) :]
        except OSError:
            self.dropped += 1
            self._told = self.dropped

    def flush(self, timeout_s: float = 1.0) -> bool:
        """Wait until the lines so far are written; False when the time ran out."""
        written = threading.Event()
        self._queue.put(written)
        return written.wait(timeout_s)

    def close(self) -> None:
        """Write what is queued, within a short limit, and end the thread."""
        self._queue.put(None)
        with suppress(RuntimeError):
            self._writer.join(CLOSE_LIMIT_S)
