# SPDX-License-Identifier: Apache-2.0
"""The clock by which the inputs of one sender are stamped, as far as their stamps agree.

By its stamps alone, one input cannot tell a clock that runs slowly from a queue that builds up:
each makes every stamp fall further behind the island's clock. Several inputs can. What all of them
fall behind by is the clock; what one falls behind the others by is delay. Two things stay delay
although all share them: what grew while nothing came for longer than usual (samples that are held
up leave a gap, a clock leaves none), and what a single input shows whose others are gone.
"""

import math

from safety_island.input_gate.clock.records import CLOCK, STAMPS
from safety_island.kernel.kernel import entry, kernel

AGREE_S = 1.0
"""Time [s] within which two inputs must have seen the same step of the clock."""

WINDOW_S = 2.5
"""Time [s], at least, over which the rate of the clock is measured. It takes two windows: a step or
a delay shows in one, a rate in both."""


@kernel
def is_heard(one, now):
    """Whether a sample was held within the age limit."""
    return now - one.held_at <= one.limit_s


@kernel
def fallen_with(one, delay_s):
    """How far a stamp with this delay has fallen behind, but for what came after a gap [s]."""
    return delay_s - one.after_gap_s + one.forgiven_s


@kernel
def fallen(one):
    """How far the held stamp has fallen behind, but for what came after a gap [s]."""
    return fallen_with(one, one.delay_s)


@kernel
def _forgive(one, seconds):
    """Count so much of it as the clock's: first what was counted so before."""
    rest_s = one.forgiven_s - seconds
    one.forgiven_s = max(rest_s, 0.0)
    one.delay_s += min(rest_s, 0.0)


@kernel
def forgive_common(stamps, asking, fallen_s, noise_s, now):
    """Count as the clock's what every input that is heard has fallen behind by.

    ``fallen_s`` [s] is that of the one that asks, with the sample that it looks at; up to
    ``noise_s`` [s] all may be behind by chance.
    """
    common_s, is_alone = fallen_s, True
    for i in range(len(stamps)):
        if i != asking and is_heard(stamps[i], now):
            common_s = min(common_s, fallen(stamps[i]))
            is_alone = False
    if is_alone or not common_s > noise_s:
        return
    for i in range(len(stamps)):
        if i == asking or is_heard(stamps[i], now):
            _forgive(stamps[i], common_s)


@kernel
def furthest_of_others(stamps, asking, now):
    """How far the others have fallen behind at most [s]: where one begins that is new."""
    furthest_s, is_alone = 0.0, True
    for i in range(len(stamps)):
        if i != asking and is_heard(stamps[i], now):
            fallen_s = fallen(stamps[i])
            if is_alone or fallen_s > furthest_s:
                furthest_s = fallen_s
            is_alone = False
    return furthest_s


@kernel
def has_stepped(stamps, asking, now):
    """Whether another input has lately seen the same step of the clock as the one that asks."""
    own = stamps[asking]
    for i in range(len(stamps)):
        one = stamps[i]
        is_recent = i != asking and now - one.claimed_at <= AGREE_S
        if is_recent and abs(one.claimed_s - own.claimed_s) <= own.limit_s / 4.0:
            return True
    return False


@entry(STAMPS, CLOCK, float)
def read_sender_clock(stamps, clocks, now):
    """Set ``time_ns`` to the time by the sender's clock; 0 when no input is heard, else 1."""
    clock, is_known = clocks[0], 0
    for i in range(len(stamps)):
        one = stamps[i]
        if is_heard(one, now) and (is_known == 0 or one.held_ns > clock.time_ns):
            clock.time_ns = one.held_ns
            is_known = 1
    return is_known


@entry(STAMPS, CLOCK, float)
def measure_sender_clock(stamps, clocks, now):
    """Measure the rate, when the window is over; 1 when it was."""
    clock = clocks[0]
    if now - clock.marked_at < WINDOW_S:
        return 0
    error = _middle_error(stamps)
    clock.rate_error = _common(error, clock.last_error)
    clock.last_error = error
    clock.marked_at = now
    for i in range(len(stamps)):
        one = stamps[i]
        one.mark_ns = one.held_ns
        one.mark_at = one.held_at
        one.mark_steps = one.steps
    return 1


@kernel
def _rate_error(one):
    """Rate of an input's stamps since they were marked, less 1; NaN when it cannot be told."""
    if one.mark_at == -math.inf or one.steps != one.mark_steps:
        return math.nan
    since_s = one.held_at - one.mark_at
    if since_s < WINDOW_S / 2.0:
        return math.nan
    return (one.held_ns - one.mark_ns) / 1e9 / since_s - 1.0


@kernel
def _middle_error(stamps):
    """What the middle one, or the middle two, of the inputs' errors agree on; 0 for one alone."""
    known = 0
    for i in range(len(stamps)):
        if not math.isnan(_rate_error(stamps[i])):
            known += 1
    if known < 2:
        return 0.0
    return _common(_error_of_rank(stamps, (known - 1) // 2), _error_of_rank(stamps, known // 2))


@kernel
def _error_of_rank(stamps, rank):
    """The error that ``rank`` others come before, in the order of size."""
    found = 0.0
    for i in range(len(stamps)):
        error, before = _rate_error(stamps[i]), 0
        for j in range(len(stamps)):
            other = _rate_error(stamps[j])
            if other < error or (other == error and j < i):
                before += 1
        if before == rank and not math.isnan(error):
            found = error
    return found


@kernel
def _common(a, b):
    """What two errors agree on: the one that is nearer to zero, 0 when the signs differ."""
    if a * b > 0.0:
        return a if abs(a) <= abs(b) else b
    return 0.0
