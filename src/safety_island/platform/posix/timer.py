"""A timer on the machine's monotonic clock."""

from __future__ import annotations

import os
import select

from safety_island.platform.grid import Grid, period_in_ns
from safety_island.platform.interfaces import Clock, Tick


class PosixTimer:
    """Sleeps in ``select`` on a pipe, so that a signal handler can end the sleep for certain.

    (A ``threading.Event`` set by a signal handler can meet its own lock.)
    """

    def __init__(self, clock: Clock, period_s: float) -> None:
        self._clock = clock
        self._grid = Grid(period_in_ns(period_s), clock.monotonic_ns())
        self._read_end, self._write_end = os.pipe()
        os.set_blocking(self._read_end, False)
        os.set_blocking(self._write_end, False)

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
        ready, _, _ = select.select((self._read_end,), (), (), delay_ns * 1e-9)
        if ready:
            os.read(self._read_end, 4096)
        return bool(ready)

    def wake(self) -> None:
        """End the present wait, or the next one, at once."""
        try:
            os.write(self._write_end, b"w")
        except BlockingIOError:
            return  # thousands of unread wakes are as good as one more

    def close(self) -> None:
        """Close the pipe."""
        os.close(self._read_end)
        os.close(self._write_end)
