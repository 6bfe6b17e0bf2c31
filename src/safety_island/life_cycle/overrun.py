# SPDX-License-Identifier: Apache-2.0
"""Whether the ticks come in time."""

from __future__ import annotations

from collections import deque

from safety_island.life_cycle.params import LifeCycleParams


class Overrun:
    """Counts late ticks and takes the mean period; told the time [s, monotonic], reads no clock.

    ``degraded``: ticks in a row were late, or the mean period is too long; ``over``: that has gone
    on for too many ticks, and the output must end. ``in_row`` counts late ticks in a row.
    """

    def __init__(self, params: LifeCycleParams, period_s: float) -> None:
        self.in_row = 0
        self.degraded = False
        self.over = False
        self._ticks = params.overrun_ticks
        self._longest_s = period_s / params.overrun_ratio * params.overrun_window
        self._times: deque[float] = deque(maxlen=params.overrun_window + 1)
        self._degraded_for = 0

    def tick(self, now: float, skipped: int) -> None:
        """Note a tick, before which ``skipped`` were missed."""
        self._times.append(now)
        self.in_row = self.in_row + 1 if skipped else 0
        self.degraded = self.in_row >= self._ticks or self._is_slow()
        self._degraded_for = self._degraded_for + 1 if self.degraded else 0
        self.over = self._degraded_for > self._ticks

    def _is_slow(self) -> bool:
        times = self._times
        return len(times) == times.maxlen and times[-1] - times[0] > self._longest_s

    def forget(self) -> None:
        """Begin anew."""
        self._times.clear()
        self.in_row = self._degraded_for = 0
        self.degraded = self.over = False
