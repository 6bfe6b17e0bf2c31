# SPDX-License-Identifier: Apache-2.0
"""A timer whose waiting moves virtual time on."""

from __future__ import annotations

from safety_island.platform.grid import Grid, period_in_ns
from safety_island.platform.interfaces import Tick
from safety_island.platform.sim.clock import SimClock


class SimTimer:
    """Waits by advancing the clock to the next tick; the actions on the way may wake it."""

    def __init__(self, clock: SimClock, period_s: float) -> None:
        self._clock = clock
        self._grid = Grid(period_in_ns(period_s), clock.monotonic_ns())
        self._woken = False

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
        """Move on to the next tick; None when woken."""
        delay_ns = self._grid.delay_ns(self._clock.monotonic_ns())
        while not self._woken:
            self._clock.advance_to_ns(self._clock.monotonic_ns() + delay_ns)
            now_ns = self._clock.monotonic_ns()
            delay_ns = self._grid.delay_ns(now_ns)
            if delay_ns == 0 and not self._woken:
                return self._grid.take(now_ns)
        self._woken = False
        return None

    def wake(self) -> None:
        """End the present wait, or the next one."""
        self._woken = True

    def close(self) -> None:
        """Nothing is held."""
