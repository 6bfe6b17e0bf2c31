# SPDX-License-Identifier: Apache-2.0
"""The stamps of one input, in the order of arrival: newer, older, standing still, delayed.

A stamp is never trusted for an age: its clock may be wrong. It orders samples, and a change of its
distance from the island's own clock, which the other inputs do not share, tells that samples take
longer than before.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from safety_island.input_gate.clock_search import ClockSearch
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.sender_clock import SenderClock
from safety_island.kernel.cdr import NANOSECONDS

BEGIN_ANEW_S = 10.0
"""After this time [s] without a sample any stamp is accepted: the clock may have been set."""

FORGET_RATE = 0.001
"""Rate [s/s] at which a delay is forgotten: two clocks may drift apart by 1000 ppm at most."""

_REMEMBERED = 1.0 - FORGET_RATE
_STEPPED, _CAUGHT_UP = -1.0, -2.0
"""In place of a delay, which is never below zero: the sender's clock was set (by so little that
it may as well have been one sample that was late)."""

STEP_TOLD_S = 1.0
"""Time [s] for which a step of the sender's clock is reported."""

USUAL_DELAY_SHARE = 0.5
"""Share of the age limit up to which a delay is not worth a report."""

NOISE_SHARE = 0.125
"""Share of the age limit up to which all inputs may have fallen behind by chance: they come
together, and are looked at once a tick."""

GAP_MARGIN = 1.25
"""How many times the longest gap between samples the next one may be, and still be usual."""

USUAL_GAP_FADES, LONGEST_GAP_FADES = 0.9, 0.97
"""What remains of a gap from one ``fade`` to the next."""


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
        self.steps_back = self.steps = 0
        """Clocks that were set back, and either way."""
        self.step_told_until = -math.inf
        """Time [s, monotonic] until which a step of the sender's clock, either way, is reported."""
        self.stamp_ns = 0
        """Stamp of the sample that was judged last [ns]."""
        self.limit_s = age_limit_s
        self.usual_delay_s = age_limit_s * USUAL_DELAY_SHARE
        self.sender = SenderClock() if sender is None else sender
        self.sender.add(self)
        self.forget()

    def forget(self) -> None:
        """Hold nothing: the next sample is accepted whatever its stamp."""
        self.delay_s = self._new_delay_s = 0.0
        self._held, self.held_ns = b"", -1
        self.held_at = self._refused_at = -math.inf
        self._search = ClockSearch(self.limit_s)
        self.claimed_s, self.claimed_at = 0.0, -math.inf
        """How far behind the clock is that refused samples speak of, and when they came last."""
        self._forgiven_s = self._after_gap_s = 0.0
        self._usual_gap_s = self._longest_gap_s = 0.0
        self._calm_delay_s = self.usual_delay_s

    def judge(
        self, stamp: tuple[int, int], data: bytes, now: float, is_successor: bool = False
    ) -> SampleReason | None:
        """Say why a sample is refused, None when its stamp is good.

        ``is_successor``: another publisher than that of the held sample sent it, perhaps by
        another clock. Its delay counts from zero, but a sample that looks delayed beyond the
        limit may be one from before: only stamps that go on show that it is the clock.
        """
        sec, nanosec = stamp
        self.stamp_ns = stamp_ns = sec * NANOSECONDS + nanosec
        step_ns, since_s = stamp_ns - self.held_ns, now - self.held_at
        delay_s = self.delay_s + since_s * _REMEMBERED - step_ns * 1e-9
        if (
            step_ns > 0
            and -self.limit_s <= delay_s <= self._calm_delay_s
            and since_s <= self._usual_gap_s
            and nanosec < NANOSECONDS
            and not is_successor
        ):
            self._new_delay_s = delay_s if delay_s > 0.0 else 0.0
            return None
        if stamp_ns <= 0 or nanosec >= NANOSECONDS:
            return self._refuse(SampleReason.BAD_STAMP)
        if step_ns == 0 and data == self._held:
            return self._refuse(SampleReason.DUPLICATE)
        reason = self._judge_rest(step_ns, delay_s, now, is_successor)
        if step_ns <= 0:
            self._refused_at = now
        return reason if reason is None else self._refuse(reason)

    def _refuse(self, reason: SampleReason) -> SampleReason:
        self.on_unusual()
        return reason

    def _judge_rest(
        self, step_ns: int, delay_s: float, now: float, is_successor: bool
    ) -> SampleReason | None:
        self._new_delay_s = 0.0
        if step_ns == 0 and (is_successor or now - self.held_at > BEGIN_ANEW_S):
            return SampleReason.STAMP_STANDS_STILL
        if now - self.held_at > BEGIN_ANEW_S:
            self._begin_anew(now)
            return None
        if is_successor:
            return self._judge_successor(step_ns, delay_s, now)
        if step_ns > 0:
            return self._judge_delay(delay_s, now)
        if self._is_set_back(delay_s, now):
            self._step(delay_s)
            return None
        return SampleReason.OLDER if step_ns else SampleReason.STAMP_STANDS_STILL

    def _begin_anew(self, now: float) -> None:
        """Begin where the other inputs are, so that they are not held against this one."""
        self.on_unusual()
        self._after_gap_s, self._calm_delay_s = 0.0, self.usual_delay_s
        self._forgiven_s = self.sender.furthest_s(self, now)

    def _judge_successor(self, step_ns: int, delay_s: float, now: float) -> SampleReason | None:
        self.on_unusual()
        reason = SampleReason.OLDER if step_ns < 0 else SampleReason.DELAYED
        if step_ns < 0 or delay_s > self.limit_s:
            if not self._search.finds(self.stamp_ns, now, self.held_at):
                return reason
            self._step(delay_s)
        elif delay_s < -self.limit_s:
            self._step(delay_s)
        return None

    def _is_set_back(self, delay_s: float, now: float) -> bool:
        """Whether a stamp that is not newer is that of a clock that was set.

        Its stamps go on for long enough, or those of another input have stepped by as much.
        """
        is_found = self._search.finds(self.stamp_ns, now, self.held_at)
        self.claimed_s, self.claimed_at = self._fallen_s(delay_s), now
        is_large = delay_s - self.delay_s > self.usual_delay_s
        if is_found or not is_large or not self._search.goes_on(now):
            return is_found
        return self.sender.has_stepped(self, self.claimed_s, now)

    def _judge_delay(self, delay_s: float, now: float) -> SampleReason | None:
        if self._belongs_to_claim(delay_s, now):
            is_large = delay_s - self.delay_s > self.usual_delay_s
            self._step(delay_s, _STEPPED if is_large else _CAUGHT_UP)
            return None
        self._note_gap(delay_s, now)
        if delay_s > self.usual_delay_s:
            before_s = self.delay_s
            noise_s = self.limit_s * NOISE_SHARE
            self.sender.forgive_common(self, self._fallen_s(delay_s), noise_s, now)
            delay_s -= before_s - self.delay_s
        if delay_s > self.limit_s:
            return SampleReason.DELAYED
        if delay_s < -self.limit_s:
            self._step(delay_s)
        else:
            self._new_delay_s = max(delay_s, 0.0)
        if not -self.limit_s <= delay_s <= self.usual_delay_s:
            self.on_unusual()
        return None

    def _note_gap(self, delay_s: float, now: float) -> None:
        """Tell delay that grew while nothing came from what may be the clock's."""
        after_gap_s = min(self._after_gap_s, max(delay_s, 0.0))
        gap_s = now - max(self.held_at, self._refused_at)
        if gap_s > self._usual_gap_s:
            if gap_s > self._longest_gap_s * GAP_MARGIN:
                after_gap_s += max(delay_s - max(self.delay_s, after_gap_s), 0.0)
            self._longest_gap_s = max(gap_s, self._longest_gap_s)
            self._usual_gap_s = min(gap_s * GAP_MARGIN, BEGIN_ANEW_S)
        self._after_gap_s = after_gap_s
        self._calm_delay_s = -math.inf if after_gap_s else self.usual_delay_s

    def _belongs_to_claim(self, delay_s: float, now: float) -> bool:
        """Whether a stamp that fits again goes on from those that were older.

        A clock was set back by so little that its stamps have caught up before they were believed:
        that is no delay. A single late sample is followed by one that is not late.
        """
        if self.claimed_at <= self.held_at or now - self.claimed_at > self.limit_s:
            return False
        return self._fallen_s(delay_s) - self.fallen_s() > (self.claimed_s - self.fallen_s()) / 2.0

    def _step(self, delay_s: float, how: float = _STEPPED) -> None:
        """Count the whole distance as the clock's."""
        self._new_delay_s = how
        self._new_forgiven_s = max(self._fallen_s(delay_s), 0.0)

    def _fallen_s(self, delay_s: float) -> float:
        return delay_s - self._after_gap_s + self._forgiven_s

    def fallen_s(self) -> float:
        """Return how far the held stamp has fallen behind [s], but for what came after a gap."""
        return self._fallen_s(self.delay_s)

    def forgive(self, seconds: float) -> None:
        """Count so much of it as the clock's: first what was counted so before."""
        rest_s = self._forgiven_s - seconds
        self._forgiven_s = max(rest_s, 0.0)
        self.delay_s += min(rest_s, 0.0)

    def is_heard(self, now: float) -> bool:
        """Whether a sample was held within the age limit."""
        return now - self.held_at <= self.limit_s

    def fade(self) -> None:
        """Let the longest gap be forgotten by and by, and the usual one looked at anew before."""
        self._usual_gap_s *= USUAL_GAP_FADES
        self._longest_gap_s *= LONGEST_GAP_FADES

    def repeats(self, data: bytes) -> bool:
        """Whether a message with its stamp in front says just what the held one says."""
        return data[_AFTER_STAMP:] == self._held[_AFTER_STAMP:]

    def hold(self, data: bytes, now: float) -> None:
        """Store the sample that was judged last."""
        delay_s = self._new_delay_s
        if delay_s < 0.0:
            if delay_s == _STEPPED:
                self.steps_back += self.stamp_ns <= self.held_ns
                self.step_told_until = now + STEP_TOLD_S
            self.steps += 1
            self._forgiven_s, self._after_gap_s = self._new_forgiven_s, 0.0
            self._calm_delay_s = self.usual_delay_s
            delay_s = 0.0
        self.delay_s = delay_s
        self._held, self.held_ns, self.held_at = data, self.stamp_ns, now


_AFTER_STAMP = 12
"""Bytes of the encapsulation header and of a stamp."""
