"""What is wrong with the inputs without ending the output: which warnings stand, and since when."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import attrgetter, gt

from safety_island.gate.params import GateParams
from safety_island.gate.warning import EXPLANATIONS, InputWarning
from safety_island.gate.warnings import warnings
from safety_island.node.input import Input
from safety_island.platform.interfaces import Logger

_SIGNS = attrgetter("rate.too_low", "stamps.delay_s", "writers.others")
"""Of an input: what is not zero when rate, delay or publishers may be worth a warning."""
_CLOCK_STEP, _CLOCK_GAP = attrgetter("stamps.step_told_until"), attrgetter("clock_gap_s")


class InputWarnings:
    """``bits`` are those of InputWarning for each input, as of the last tick."""

    def __init__(self, items: Sequence[Input], params: GateParams, logger: Logger) -> None:
        self.bits = [0] * len(items)
        self._items, self._logger = items, logger
        self._oldest_s = [item.age_warning_s for item in items]
        # the last one, the operation mode, was stamped when it changed
        self._widest_gap_s = [params.clock_warning] * (len(items) - 1) + [math.inf]

    def update(self, now: float, ages_s: Sequence[float], is_settled: bool) -> None:
        """Look which warnings stand at ``now`` [s, monotonic], and log those that are new.

        ``is_settled``: no publisher came or went within the last second.
        """
        if is_settled and not any(self.bits) and self._is_calm(now, ages_s):
            return
        found = [self._look(index, now, age_s) for index, age_s in enumerate(ages_s)]
        if found != self.bits:
            self._tell(found)

    def _is_calm(self, now: float, ages_s: Sequence[float]) -> bool:
        """Whether there is nothing to warn of: the usual case, told without a look at each."""
        items = self._items
        return not (
            any(map(any, map(_SIGNS, items)))
            or max(map(_CLOCK_STEP, items)) >= now
            or any(map(gt, ages_s, self._oldest_s))
            or any(map(gt, map(_CLOCK_GAP, items), self._widest_gap_s))
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
