# SPDX-License-Identifier: Apache-2.0
"""What is wrong with the inputs without ending the output: which warnings stand, and since when."""

from __future__ import annotations

import math
from collections.abc import Sequence

from safety_island.input_gate.params import GateParams
from safety_island.input_gate.sender_clock import SenderClock
from safety_island.input_gate.warning import EXPLANATIONS, InputWarning
from safety_island.input_gate.warnings import warnings
from safety_island.node.input import Input
from safety_island.platform.interfaces import Clock, Logger

WATCH_EVERY_S = 0.5
"""Time [s] between two looks at what changes slowly: rates, and the senders' clocks."""

_FLEETING = int(~(InputWarning.RATE | InputWarning.CLOCK | InputWarning.CLOCK_RATE))
"""Warnings that may end with any tick, and not only with such a look."""


class InputWarnings:
    """``bits`` are those of InputWarning for each input, as of the last tick.

    It sleeps while none can change: ages, an unusual stamp, and publishers that come or go wake it,
    and so does every look at what changes slowly.
    """

    def __init__(
        self,
        items: Sequence[Input],
        sender: SenderClock,
        params: GateParams,
        clock: Clock,
        logger: Logger,
    ) -> None:
        self.bits = [0] * len(items)
        self._items, self._sender, self._clock, self._logger = items, sender, clock, logger
        self._oldest_s = [item.age_warning_s for item in items]
        # the last one, the operation mode, was stamped when it changed
        self._widest_gap_s = [params.clock_warning] * (len(items) - 1) + [math.inf]
        self._watch_at = -math.inf
        self._is_awake = True
        for item in items:
            item.stamps.on_unusual = self.wake

    def wake(self) -> None:
        """Look at every input in the next ``update``."""
        self._is_awake = True

    def update(self, now: float, ages_s: Sequence[float], is_calm: bool) -> None:
        """Look which warnings stand at ``now`` [s, monotonic], and log those that are new.

        ``is_calm``: no age is worth a warning, each topic has one publisher, and none came or went
        within the last second.
        """
        if now >= self._watch_at:
            self._watch(now)
        if is_calm and not self._is_awake:
            return
        found = [self._look(index, now, age_s) for index, age_s in enumerate(ages_s)]
        if found != self.bits:
            self._tell(found)
        self._is_awake = any([bits & _FLEETING for bits in found])

    def _watch(self, now: float) -> None:
        wall_ns = self._clock.wall_ns()
        for item in self._items:
            item.watch(now, wall_ns)
        self._sender.measure(now)
        self._watch_at = now + WATCH_EVERY_S
        self.wake()

    def _look(self, index: int, now: float, age_s: float) -> int:
        item = self._items[index]
        if item.message is None:
            return 0
        is_old = age_s > self._oldest_s[index]
        is_off = item.clock_gap_s > self._widest_gap_s[index]
        is_turned = item.replaced > 0
        return warnings(now, item.stamps, item.writers, item.rate, is_old, is_off, is_turned)

    def _tell(self, found: list[int]) -> None:
        self.bits = found
        for item, new in zip(self._items, found, strict=True):
            old, item.warnings = item.warnings, new
            for bit in InputWarning(new & ~old):
                what = EXPLANATIONS[bit][0]
                site = f"{item.topic} {bit.name}"
                self._logger.warning("%s: %s", item.name, what, throttled=True, site=site)
