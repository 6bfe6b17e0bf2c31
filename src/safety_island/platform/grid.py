# SPDX-License-Identifier: Apache-2.0
"""The fixed time grid of a timer: which tick is next, which were missed. Pure arithmetic."""

from __future__ import annotations

from safety_island.errors import ConfigurationError
from safety_island.platform.interfaces import Tick

NANOSECONDS = 1_000_000_000


def period_in_ns(period_s: float) -> int:
    """Return a period [s] in nanoseconds. Raises ConfigurationError outside (1 us, 1 h)."""
    if not 1e-6 <= period_s <= 3600.0:
        raise ConfigurationError(
            f"timer period {period_s} s cannot be used: give seconds from 0.000001 to 3600"
        )
    return round(period_s * NANOSECONDS)


class Grid:
    """Times ``start + k * period``, k = 1, 2, ..., each given out at most once."""

    def __init__(self, period_ns: int, start_ns: int) -> None:
        self.period_ns = period_ns
        self.next_ns = start_ns + period_ns
        self.ticks = 0
        self.skipped = 0
        self._skipped_before = 0

    def delay_ns(self, now_ns: int) -> int:
        """Return how long [ns] the next tick is away (0: due), after skipping what was missed.

        Up to half a period late a tick still counts as this one; beyond that the next place on the
        grid is nearer, and running at once would put two ticks close together.
        """
        too_late = now_ns - self.next_ns - self.period_ns // 2
        if too_late > 0:
            missed = -(-too_late // self.period_ns)
            self.next_ns += missed * self.period_ns
            self.skipped += missed
        return max(self.next_ns - now_ns, 0)

    def take(self, now_ns: int) -> Tick:
        """Give out the tick that is due."""
        tick = Tick(self.next_ns, now_ns - self.next_ns, self.skipped - self._skipped_before)
        self._skipped_before = self.skipped
        self.next_ns += self.period_ns
        self.ticks += 1
        return tick
