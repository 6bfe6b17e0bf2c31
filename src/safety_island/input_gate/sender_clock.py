# SPDX-License-Identifier: Apache-2.0
"""The clock by which the inputs of one sender are stamped, as far as their stamps agree.

By its stamps alone, one input cannot tell a clock that runs slowly from a queue that builds up:
each makes every stamp fall further behind the island's clock. Several inputs can. What all of them
fall behind by is the clock; what one falls behind the others by is delay. Two things stay delay
although all share them: what grew while nothing came for longer than usual (samples that are held
up leave a gap, a clock leaves none), and what a single input shows whose others are gone.
"""

from __future__ import annotations

import math
from typing import Protocol

AGREE_S = 1.0
"""Time [s] within which two inputs must have seen the same step of the clock."""

WINDOW_S = 2.5
"""Time [s], at least, over which the rate of the clock is measured. It takes two windows: a step or
a delay shows in one, a rate in both."""

LARGEST_RATE_ERROR = 0.01
"""Difference of the common rate from 1 that is warned of; two real clocks differ by 0.001."""

_NEVER = -math.inf


class Stamped(Protocol):
    """What the clock asks of the stamps of one input; times in s, monotonic."""

    held_ns: int
    held_at: float
    limit_s: float
    steps: int
    claimed_s: float
    claimed_at: float

    def is_heard(self, now: float) -> bool:
        """Whether a sample was accepted within the age limit."""

    def fallen_s(self) -> float:
        """How far its stamps have fallen behind, but for what came after a gap."""

    def forgive(self, seconds: float) -> None:
        """Count so much of it as the clock's."""


class SenderClock:
    """Compares the inputs that ``add`` names. Nothing is asked of it while stamps are usual."""

    def __init__(self) -> None:
        self.rate_error = 0.0
        """Common rate of the stamps, less 1: the least of the last two windows, 0 when they do
        not agree."""
        self._last_error = 0.0
        self._inputs: list[Stamped] = []
        self._marks: list[tuple[int, float, int]] = []
        self._marked_at = _NEVER

    def add(self, stamps: Stamped) -> None:
        """Compare one more input."""
        self._inputs.append(stamps)

    @property
    def is_off(self) -> bool:
        """Whether the clock runs at another rate than the island's own."""
        return abs(self.rate_error) > LARGEST_RATE_ERROR

    def forgive_common(self, asking: Stamped, fallen_s: float, noise_s: float, now: float) -> None:
        """Count as the clock's what every input that is heard has fallen behind by.

        ``fallen_s`` [s] is that of the one that asks, with the sample that it looks at; up to
        ``noise_s`` [s] all may be behind by chance.
        """
        heard = [one for one in self._inputs if one is not asking and one.is_heard(now)]
        if not heard:
            return
        common_s = min(fallen_s, *(one.fallen_s() for one in heard))
        if common_s > noise_s:
            for one in (asking, *heard):
                one.forgive(common_s)

    def furthest_s(self, asking: Stamped, now: float) -> float:
        """Return how far the others have fallen behind at most: where one begins that is new."""
        others = [o.fallen_s() for o in self._inputs if o is not asking and o.is_heard(now)]
        return max(others, default=0.0)

    def has_stepped(self, asking: Stamped, claimed_s: float, now: float) -> bool:
        """Whether another input has lately seen the same step of the clock, back by so much."""
        tolerance_s = asking.limit_s / 4.0
        return any(
            now - one.claimed_at <= AGREE_S and abs(one.claimed_s - claimed_s) <= tolerance_s
            for one in self._inputs
            if one is not asking
        )

    def stamp_ns(self, now: float) -> int | None:
        """Return the time by the sender's clock [ns], None when no input is heard."""
        heard = [one.held_ns for one in self._inputs if one.is_heard(now)]
        return max(heard, default=None)

    def measure(self, now: float) -> None:
        """Measure the rate, when the window is over."""
        if now - self._marked_at < WINDOW_S:
            return
        marks = [(one.held_ns, one.held_at, one.steps) for one in self._inputs]
        errors = [_rate_error(*pair) for pair in zip(self._marks, marks, strict=False)]
        known = sorted(error for error in errors if error is not None)
        error = _common(known[(len(known) - 1) // 2 : len(known) // 2 + 1]) if known[1:] else 0.0
        self.rate_error, self._last_error = _common([error, self._last_error]), error
        self._marks, self._marked_at = marks, now


def _rate_error(old: tuple[int, float, int], new: tuple[int, float, int]) -> float | None:
    """Return the rate of an input's stamps, less 1; None when it cannot be told."""
    since_s = new[1] - old[1]
    if old[1] == _NEVER or since_s < WINDOW_S / 2.0 or new[2] != old[2]:
        return None
    return (new[0] - old[0]) / 1e9 / since_s - 1.0


def _common(errors: list[float]) -> float:
    """Return what they agree on: the error that is nearest to zero, 0 when the signs differ."""
    least = min(errors, key=abs)
    return least if all(error * least > 0.0 for error in errors) else 0.0
