"""What is wrong with the inputs without ending the output: which warnings stand, and since when."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import attrgetter, gt

from safety_island.gate.params import GateParams
from safety_island.gate.warning import EXPLANATIONS, InputWarning
from safety_island.gate.warnings import longest_delay_s, warnings
from safety_island.node.input import Input
from safety_island.platform.interfaces import Logger

WATCH_EVERY_S = 0.5
"""Time [s] between two looks at what changes slowly: rates, and the senders' clocks."""


_DELAY, _STEP_TOLD_UNTIL = attrgetter("delay_s"), attrgetter("step_told_until")


class InputWarnings:
    """``bits`` are those of InputWarning for each input, as of the last tick."""

    def __init__(self, items: Sequence[Input], params: GateParams, logger: Logger) -> None:
        self.bits = [0] * len(items)
        self._items, self._logger = items, logger
        self._oldest_s = [item.age_warning_s for item in items]
        self._stamps = [item.stamps for item in items]
        self._usual_delay_s = min(longest_delay_s(item.age_limit_s) for item in items)
        # the last one, the operation mode, was stamped when it changed
        self._widest_gap_s = [params.clock_warning] * (len(items) - 1) + [math.inf]
        self._watch_at = -math.inf
        self._is_calm = True
        """Whether no warning stands, and rates and clocks give no reason for one."""

    def update(self, now: float, wall_ns: int, ages_s: Sequence[float], is_settled: bool) -> None:
        """Look which warnings stand at ``now`` [s, monotonic], and log those that are new.

        ``is_settled``: each topic has one publisher, and none came or went within the last second.
        """
        if now >= self._watch_at:
            self._watch(now, wall_ns)
        if is_settled and self._is_calm and not self._is_odd(now, ages_s):
            return
        found = [self._look(index, now, age_s) for index, age_s in enumerate(ages_s)]
        if found != self.bits:
            self._tell(found)
        self._is_calm = not any(found)

    def _watch(self, now: float, wall_ns: int) -> None:
        for item in self._items:
            item.watch(now, wall_ns)
        self._watch_at = now + WATCH_EVERY_S
        self._is_calm = False

    def _is_odd(self, now: float, ages_s: Sequence[float]) -> bool:
        """Whether ages, delays or steps of clocks give reason for a look at each input."""
        return (
            max(map(_DELAY, self._stamps)) > self._usual_delay_s
            or max(map(_STEP_TOLD_UNTIL, self._stamps)) >= now
            or any(map(gt, ages_s, self._oldest_s))
        )

    def _look(self, index: int, now: float, age_s: float) -> int:
        item = self._items[index]
        if item.message is None:
            return 0
        is_old = age_s > self._oldest_s[index]
        is_off = item.clock_gap_s > self._widest_gap_s[index]
        return warnings(now, item.stamps, item.writers, item.rate, is_old, is_off)

    def _tell(self, found: list[int]) -> None:
        self.bits = found
        for item, new in zip(self._items, found, strict=True):
            old, item.warnings = item.warnings, new
            for bit in InputWarning(new & ~old):
                what = EXPLANATIONS[bit][0]
                site = f"{item.topic} {bit.name}"
                self._logger.warning("%s: %s", item.name, what, throttled=True, site=site)
