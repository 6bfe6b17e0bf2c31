# SPDX-License-Identifier: Apache-2.0
"""A timer on the machine's monotonic clock."""

from __future__ import annotations

import os
import select

from safety_island.platform.grid import Grid, period_in_ns
from safety_island.platform.interfaces import Clock, Tick


class PosixTimer:
    """Sleeps in ``select`` on an event counter, so that a signal handler can surely end the sleep.

    (A ``threading.Event`` set by a signal handler can meet its own lock.)
    """

    def __init__(self, clock: Clock, period_s: float) -> None:
        self._clock = clock
        self._grid = Grid(period_in_ns(period_s), clock.monotonic_ns())
        self._event = os.eventfd(0)

    @property
    def period_ns(self) -> int:
        """Distance [ns] of two places on the grid."""
        return self._grid.period_ns

    @property
    def ticks(self) -> int:
        """Ticks that were given out."""
        return self._grid.ticks

    @property
    def skipped(self) -> int:
        """Ticks that were missed."""
        return self._grid.skipped

    def wait(self) -> Tick | None:
        """Wait for the next tick; None when woken."""
        while True:
            delay_ns = self._grid.delay_ns(self._clock.monotonic_ns())
            if self._was_woken(delay_ns):
                return None
            now_ns = self._clock.monotonic_ns()
            if self._grid.delay_ns(now_ns) == 0:
                return self._grid.take(now_ns)

    def _was_woken(self, delay_ns: int) -> bool:
        """Sleep for a time; True when ``wake`` was called before its end."""
        ready, _, _ = select.select((self._event,), (), (), delay_ns * 1e-9)
        if ready:
            os.eventfd_read(self._event)
        return bool(ready)

    def wake(self) -> None:
        """End the present wait, or the next one, at once."""
        os.eventfd_write(self._event, 1)

    def close(self) -> None:
        """Close the event counter."""
        os.close(self._event)
