"""The stamps of one input, in the order of arrival: newer, older, standing still, delayed.

A stamp is never trusted for an age: its clock may be wrong. It orders samples, and a change of its
distance from the island's own clock tells that samples take longer than before.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from safety_island.gate.clock_search import ClockSearch
from safety_island.gate.reason import SampleReason
from safety_island.messages.wire import NANOSECONDS, Time

BEGIN_ANEW_S = 10.0
"""After this time [s] without a sample any stamp is taken: the sender's clock may have been set."""

FORGET_RATE = 0.001
"""Rate [s/s] at which a delay is forgotten: two clocks may drift apart by 1000 ppm at most."""

_REMEMBERED = 1.0 - FORGET_RATE
_STEPPED = -1.0
"""In place of a delay, which is never below zero: the sender's clock was set."""

STEP_TOLD_S = 1.0
"""Time [s] for which a step of the sender's clock is told."""

USUAL_DELAY_SHARE = 0.5
"""Share of the age limit up to which a delay is nothing to tell."""


def _nobody() -> None:
    """Whom an unusual sample is told when nobody asked for it."""


class StampGate:
    """Judges each sample by its stamp; told the time [s, monotonic], reads no clock.

    ``judge`` leaves everything as it was but the search for another clock; ``hold`` takes the
    judged sample over. ``delay_s`` [s] is how much longer the held sample took than the quickest
    one; ``steps_back`` counts clocks that were set back. One that was set forward shows in a
    sample that is quicker than any before by more than the age limit: no delay was that long,
    since what is delayed by more is refused.
    """

    def __init__(self, age_limit_s: float = math.inf) -> None:
        self.on_unusual: Callable[[], None] = _nobody
        """Told of each sample that gives reason to look at delay and clock; the others give none.
        """
        self.steps_back = 0
        self.step_told_until = -math.inf
        """Time [s, monotonic] until which a step of the sender's clock, either way, is told."""
        self.stamp_ns = 0
        """Stamp of the sample that was judged last [ns]."""
        self.limit_s = age_limit_s
        self.usual_delay_s = age_limit_s * USUAL_DELAY_SHARE
        self._is_sent_on_change = age_limit_s == math.inf  # refused, it would not be told again
        self.forget()

    def forget(self) -> None:
        """Hold nothing: the next sample is taken whatever its stamp."""
        self.delay_s = self._new_delay_s = 0.0
        self._held, self._held_ns = b"", -1
        self._held_at = -math.inf
        self._search = ClockSearch(self.limit_s)

    def judge(
        self, stamp: Time, data: bytes, now: float, is_successor: bool = False
    ) -> SampleReason | None:
        """Say why a sample is refused, None when its stamp is good.

        ``is_successor``: another publisher than that of the held sample sent it, perhaps by
        another clock. Its delay counts from zero, but a sample that looks delayed beyond the
        limit may be one from before: only stamps that go on show that it is the clock.
        """
        sec, nanosec = stamp
        self.stamp_ns = stamp_ns = sec * NANOSECONDS + nanosec
        step_ns, since_s = stamp_ns - self._held_ns, now - self._held_at
        delay_s = self.delay_s + since_s * _REMEMBERED - step_ns * 1e-9
        if (
            step_ns > 0
            and -self.limit_s <= delay_s <= self.usual_delay_s
            and since_s <= BEGIN_ANEW_S
            and nanosec < NANOSECONDS
            and not is_successor
        ):
            self._new_delay_s = delay_s if delay_s > 0.0 else 0.0
            return None
        self.on_unusual()
        if stamp_ns <= 0 or nanosec >= NANOSECONDS:
            return SampleReason.BAD_STAMP
        if step_ns == 0 and data == self._held:
            return SampleReason.DUPLICATE
        if step_ns == 0 and not self._is_sent_on_change:
            return SampleReason.STAMP_STANDS_STILL
        return self._judge_unusual(step_ns, delay_s, now, is_successor)

    def _judge_unusual(
        self, step_ns: int, delay_s: float, now: float, is_successor: bool
    ) -> SampleReason | None:
        self._new_delay_s = 0.0
        if now - self._held_at > BEGIN_ANEW_S:
            return None
        if step_ns < 0:
            return self._judge_misfit(SampleReason.OLDER, now)
        if delay_s > self.limit_s:
            late = SampleReason.DELAYED
            return self._judge_misfit(late, now) if is_successor else late
        if delay_s < -self.limit_s:
            self._new_delay_s = _STEPPED
        elif not is_successor:
            self._new_delay_s = max(delay_s, 0.0)
        return None

    def _judge_misfit(self, reason: SampleReason, now: float) -> SampleReason | None:
        is_found = self._is_sent_on_change or self._search.finds(self.stamp_ns, now, self._held_at)
        if not is_found:
            return reason
        self._new_delay_s = _STEPPED
        return None

    def repeats(self, data: bytes) -> bool:
        """Whether a message with its stamp in front says just what the held one says."""
        return data[_AFTER_STAMP:] == self._held[_AFTER_STAMP:]

    def hold(self, data: bytes, now: float) -> None:
        """Take the sample that was judged last."""
        delay_s = self._new_delay_s
        if delay_s < 0.0:
            delay_s = 0.0
            self.steps_back += self.stamp_ns < self._held_ns
            self.step_told_until = now + STEP_TOLD_S
        self.delay_s = delay_s
        self._held, self._held_ns, self._held_at = data, self.stamp_ns, now


_AFTER_STAMP = 12
"""Bytes of the encapsulation header and of a stamp."""
