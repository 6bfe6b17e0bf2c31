# SPDX-License-Identifier: Apache-2.0
"""A CAN bus beside the domain: its newest command, raw and decoded, read by a thread of its own."""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator
from typing import Any

from safety_island.can.candump import LogEntry, format_frame
from safety_island.can.live import watch
from safety_island.can.monitor import RECENT, BusMonitor
from safety_island.can.report import command_values
from safety_island.can.spec import BusSpec
from safety_island.monitor.hub import Hub

SHOW_EVERY_S = 0.2
END_LIMIT_S = 1.0
"""The reader looks for its end ten times a second."""

MonotonicNs = Callable[[], int]


class BusFeed:
    """Reads a bus from its making on; ``poll`` publishes what was read, and ``close`` ends it.

    Raises ConfigurationError and CanError for a bus that cannot be read.
    """

    def __init__(self, spec: BusSpec, clock_ns: MonotonicNs) -> None:
        self._clock_ns = clock_ns
        self._entries: Generator[LogEntry | None] = watch(spec)
        self._monitor = BusMonitor(None, RECENT, clock_ns() / 1e9)
        self._frames: dict[int, str] = {}
        self._lock = threading.Lock()
        self._is_closed = False
        self._shown_at = float("-inf")
        self._feed(next(self._entries))  # opens the bus
        self._thread = threading.Thread(target=self._read, name="can", daemon=True)
        self._thread.start()

    def poll(self, hub: Hub, now: float) -> None:
        """Publish the newest command, and the alarm where none comes; ``now`` [s] is the page's."""
        if now - self._shown_at < SHOW_EVERY_S:
            return
        self._shown_at = now
        with self._lock:
            hub.publish("can", {"t": round(now, 3), "can": self._values()})

    def close(self) -> None:
        """End the reader and close the bus."""
        self._is_closed = True
        self._thread.join(END_LIMIT_S)
        if not self._thread.is_alive():
            self._entries.close()

    def _values(self) -> dict[str, Any]:
        monitor = self._monitor
        values: dict[str, Any] = {"frames": list(self._frames.values())}
        if monitor.latest is not None:
            values |= command_values(monitor.latest)
        if alarm := monitor.alarm(self._clock_ns() / 1e9):
            values["fault"] = alarm
        return values

    def _read(self) -> None:
        for entry in self._entries:
            if self._is_closed:
                return
            self._feed(entry)

    def _feed(self, entry: LogEntry | None) -> None:
        if entry is None:
            return
        with self._lock:
            self._monitor.feed(entry, self._clock_ns() / 1e9)
            if entry.frame is not None and entry.frame.arbitration_id in self._monitor.frames:
                self._frames[entry.frame.arbitration_id] = format_frame(entry.frame)
