# SPDX-License-Identifier: Apache-2.0
"""The stamps of one input, as Python sees them; their rules are those of ``clock``."""

from __future__ import annotations

import math
from collections.abc import Callable

from safety_island.input_gate.clock.judge import (
    USUAL_DELAY_SHARE,
    fade_gaps,
    hold_stamp,
    judge_stamp,
)
from safety_island.input_gate.clock.records import forget
from safety_island.input_gate.reason import GOOD, SampleReason
from safety_island.input_gate.sender_clock import SenderClock
from safety_island.kernel.records import Records, cells

_AFTER_STAMP = 12
"""Bytes of the encapsulation header and of a stamp."""


def _ignore() -> None:
    """Do nothing: the default for ``on_unusual``."""


class StampGate:
    """Checks each sample by its stamp; told the time [s, monotonic], reads no clock.

    ``judge`` changes nothing but the search for another clock and what is counted as the clock's;
    ``hold`` stores the judged sample. ``delay_s`` [s] is how much longer the held sample took than
    the quickest one; ``steps_back`` counts clocks that were set back. One that was set forward
    shows in a sample that is quicker than any before by more than the age limit: no delay was that
    long, since what is delayed by more is refused. ``sender``: compares it with other inputs.
    """

    def __init__(self, age_limit_s: float = math.inf, sender: SenderClock | None = None) -> None:
        self.on_unusual: Callable[[], None] = _ignore
        """Called for each sample that gives reason to look at delay and clock; the others give
        none."""
        self.sender = SenderClock() if sender is None else sender
        self.limit_s = age_limit_s
        self.usual_delay_s = age_limit_s * USUAL_DELAY_SHARE
        self._place = self.sender.add(age_limit_s)
        stamps = self.sender.stamps
        self.state: Records = stamps[self._place : self._place + 1]
        """STAMPS record of shape (1,)."""
        cell = cells(self.state)
        self._is_unusual, self._delay, self._stamp = (
            cell[name] for name in ("is_unusual", "delay_s", "stamp_ns")
        )
        self._told_until = cell["step_told_until"]
        self._steps, self._back = cell["steps"], cell["steps_back"]
        self._judge = judge_stamp.bind(stamps)
        self._hold = hold_stamp.bind(stamps)
        self._fade = fade_gaps.bind(stamps)
        self._held = b""

    @property
    def delay_s(self) -> float:
        """How much longer the held sample took than the quickest one [s]."""
        return float(self._delay[0])

    @property
    def stamp_ns(self) -> int:
        """Stamp of the sample that was judged last [ns]."""
        return int(self._stamp[0])

    @property
    def steps(self) -> int:
        """Clocks that were set, either way."""
        return int(self._steps[0])

    @property
    def steps_back(self) -> int:
        """Clocks that were set back."""
        return int(self._back[0])

    @property
    def step_told_until(self) -> float:
        """Time [s, monotonic] until which a step of the sender's clock, either way, is reported."""
        return float(self._told_until[0])

    def forget(self) -> None:
        """Hold nothing: the next sample is accepted whatever its stamp."""
        forget(self.state)
        self._held = b""

    def judge(
        self, stamp: tuple[int, int], data: bytes, now: float, is_successor: bool = False
    ) -> SampleReason | None:
        """Say why a sample is refused, None when its stamp is good; see ``judge_stamp``."""
        sec, nanosec = stamp
        is_same = data == self._held
        reason = self._judge(self._place, sec, nanosec, is_same, is_successor, now)
        if self._is_unusual[0]:
            self.on_unusual()
        return None if reason == GOOD else SampleReason(reason)

    def fade(self) -> None:
        """Let the gaps between samples be forgotten by and by."""
        self._fade(self._place)

    def repeats(self, data: bytes) -> bool:
        """Whether a message with its stamp in front says just what the held one says."""
        return data[_AFTER_STAMP:] == self._held[_AFTER_STAMP:]

    def hold(self, data: bytes, now: float) -> None:
        """Store the sample that was judged last."""
        self._hold(self._place, now)
        self._held = data
