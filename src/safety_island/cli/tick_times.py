# SPDX-License-Identifier: Apache-2.0
"""Statistics of a run of any length in memory of a fixed size."""

from __future__ import annotations

from array import array
from math import ceil, exp, log

SHORTEST_S, LONGEST_S = 1e-6, 100.0
"""Times [s] outside are counted in the first or the last bucket."""
RATIO = 1.01
"""Upper over lower bound of a bucket: how far a quantile may lie above the exact one."""


class TickTimes:
    """A histogram with logarithmic buckets; the memory is taken once, when it is made.

    A quantile is the upper bound of its bucket, so it is never below the exact nearest-rank
    quantile and at most 1 % above it (from 1 us to 100 s); the maximum is exact.
    """

    def __init__(self) -> None:
        self._scale = 1.0 / log(RATIO)
        buckets = ceil(log(LONGEST_S / SHORTEST_S) * self._scale) + 1
        self._counts = array("Q", bytes(8 * buckets))
        self.count = 0
        self.max_s = 0.0

    def add(self, time_s: float) -> None:
        """Count one time [s]."""
        bounded = min(max(time_s, SHORTEST_S), LONGEST_S)
        self._counts[ceil(log(bounded / SHORTEST_S) * self._scale)] += 1
        self.count += 1
        self.max_s = max(self.max_s, time_s)

    def quantile(self, percent: float) -> float | None:
        """Return the nearest-rank quantile [s], at most 1 % too high; None when there is none."""
        rank = max(-(-self.count * percent // 100), 1)
        seen = 0
        for index, number in enumerate(self._counts):
            seen += number
            if seen >= rank:
                return min(SHORTEST_S * exp(index / self._scale), self.max_s)
        return None
