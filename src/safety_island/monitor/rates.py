# SPDX-License-Identifier: Apache-2.0
"""Rates from counters, and the control period as it is kept."""

from __future__ import annotations

from collections import deque
from statistics import median

WINDOW_S = 4.0
"""A rate is taken over so long a time [s]."""
PERIODS = 15


class Rate:
    """How fast a counter grows."""

    def __init__(self) -> None:
        self._seen: deque[tuple[float, int]] = deque()

    def next(self, now: float, count: int) -> float | None:
        """Take the count at ``now`` [s]; return the rate [1/s], None before it can be known."""
        if self._seen and count < self._seen[-1][1]:  # another island counts from zero
            self._seen.clear()
        self._seen.append((now, count))
        while len(self._seen) > 2 and self._seen[1][0] <= now - WINDOW_S:
            self._seen.popleft()
        (first, before), (last, after) = self._seen[0], self._seen[-1]
        return (after - before) / (last - first) if last - first >= WINDOW_S / 2 else None


class Period:
    """The control period, from the stamps of ticks that follow each other."""

    def __init__(self) -> None:
        self._steps: deque[float] = deque(maxlen=PERIODS)
        self._last: tuple[int, float] | None = None

    def next(self, tick: int, stamp_s: float) -> float | None:
        """Take a tick and its stamp [s]; return the period [s], None before it can be known."""
        if self._last is not None and tick == self._last[0] + 1 and stamp_s > self._last[1]:
            self._steps.append(stamp_s - self._last[1])
        self._last = tick, stamp_s
        return median(self._steps) if len(self._steps) >= 3 else None
