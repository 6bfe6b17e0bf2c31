# SPDX-License-Identifier: Apache-2.0
"""The stamps of one input, in the order of arrival: newer, older, standing still, delayed.

A stamp is never trusted for an age: its clock may be wrong. It orders samples, and a change of its
distance from the island's own clock, which the other inputs do not share, tells that samples take
longer than before.
"""

from safety_island.input_gate.clock.records import STAMPS
from safety_island.input_gate.clock.search import finds, goes_on
from safety_island.input_gate.clock.sender import (
    fallen,
    fallen_with,
    forgive_common,
    furthest_of_others,
    has_stepped,
)
from safety_island.input_gate.reason import GOOD, SampleReason
from safety_island.kernel.cdr import NANOSECONDS
from safety_island.kernel.kernel import entry, kernel

BEGIN_ANEW_S = 10.0
"""After this time [s] without a sample any stamp is accepted: the clock may have been set."""

FORGET_RATE = 0.001
"""Rate [s/s] at which a delay is forgotten: two clocks may drift apart by 1000 ppm at most."""

STEPPED, CAUGHT_UP = -1.0, -2.0
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
"""What remains of a gap from one ``fade_gaps`` to the next."""

_REMEMBERED = 1.0 - FORGET_RATE
_BAD_STAMP = int(SampleReason.BAD_STAMP)
_DUPLICATE = int(SampleReason.DUPLICATE)
_STANDS_STILL = int(SampleReason.STAMP_STANDS_STILL)
_OLDER = int(SampleReason.OLDER)
_DELAYED = int(SampleReason.DELAYED)


@entry(STAMPS, int, int, int, int, int, float)
def judge_stamp(stamps, place, sec, nanosec, is_same, is_successor, now):
    """Say why a sample of the input at ``place`` is refused, GOOD when its stamp is good.

    ``is_same``: its bytes are those of the held one. ``is_successor``: another publisher than that
    of the held sample sent it, perhaps by another clock. Its delay counts from zero, but a sample
    that looks delayed beyond the limit may be one from before: only stamps that go on show that it
    is the clock. Changes nothing but the search for another clock, and what is counted as the
    clock's.
    """
    one = stamps[place]
    one.stamp_ns = sec * NANOSECONDS + nanosec
    one.is_unusual = False
    step_ns = one.stamp_ns - one.held_ns
    if one.stamp_ns <= 0 or nanosec >= NANOSECONDS:
        reason = _BAD_STAMP
    elif step_ns == 0 and is_same:
        reason = _DUPLICATE
    else:
        reason = _judge_step(stamps, place, step_ns, is_successor, now)
        if step_ns <= 0:
            one.refused_at = now
    if reason != GOOD:
        one.is_unusual = True
    return reason


@kernel
def _judge_step(stamps, place, step_ns, is_successor, now):
    one = stamps[place]
    since_s = now - one.held_at
    delay_s = one.delay_s + since_s * _REMEMBERED - step_ns * 1e-9
    one.new_delay_s = 0.0
    if step_ns == 0 and (is_successor or since_s > BEGIN_ANEW_S):
        return _STANDS_STILL
    if since_s > BEGIN_ANEW_S:
        _begin_anew(stamps, place, now)
        return GOOD
    if is_successor:
        return _judge_successor(one, step_ns, delay_s, now)
    if step_ns > 0:
        return _judge_delay(stamps, place, delay_s, now)
    if _is_set_back(stamps, place, delay_s, now):
        _step(one, delay_s, STEPPED)
        return GOOD
    return _OLDER if step_ns < 0 else _STANDS_STILL


@kernel
def _begin_anew(stamps, place, now):
    """Begin where the other inputs are, so that they are not held against this one."""
    one = stamps[place]
    one.is_unusual = True
    one.after_gap_s = 0.0
    one.forgiven_s = furthest_of_others(stamps, place, now)


@kernel
def _judge_successor(one, step_ns, delay_s, now):
    one.is_unusual = True
    if step_ns < 0 or delay_s > one.limit_s:
        if not finds(one, now):
            return _OLDER if step_ns < 0 else _DELAYED
        _step(one, delay_s, STEPPED)
    elif delay_s < -one.limit_s:
        _step(one, delay_s, STEPPED)
    return GOOD


@kernel
def _is_large(one, delay_s):
    """Whether a delay grew by more than is usual."""
    return delay_s - one.delay_s > one.limit_s * USUAL_DELAY_SHARE


@kernel
def _is_set_back(stamps, place, delay_s, now):
    """Whether a stamp that is not newer is that of a clock that was set.

    Its stamps go on for long enough, or those of another input have stepped by as much.
    """
    one = stamps[place]
    is_found = finds(one, now)
    one.claimed_s = fallen_with(one, delay_s)
    one.claimed_at = now
    if is_found or not _is_large(one, delay_s) or not goes_on(one, now):
        return is_found
    return has_stepped(stamps, place, now)


@kernel
def _judge_delay(stamps, place, delay_s, now):
    one = stamps[place]
    if _belongs_to_claim(one, delay_s, now):
        _step(one, delay_s, STEPPED if _is_large(one, delay_s) else CAUGHT_UP)
        return GOOD
    _note_gap(one, delay_s, now)
    usual_s = one.limit_s * USUAL_DELAY_SHARE
    if delay_s > usual_s:
        before_s = one.delay_s
        noise_s = one.limit_s * NOISE_SHARE
        forgive_common(stamps, place, fallen_with(one, delay_s), noise_s, now)
        delay_s -= before_s - one.delay_s
    if delay_s > one.limit_s:
        return _DELAYED
    if delay_s < -one.limit_s:
        _step(one, delay_s, STEPPED)
    else:
        one.new_delay_s = max(delay_s, 0.0)
    one.is_unusual = delay_s < -one.limit_s or delay_s > usual_s
    return GOOD


@kernel
def _note_gap(one, delay_s, now):
    """Tell delay that grew while nothing came from what may be the clock's."""
    after_gap_s = min(one.after_gap_s, max(delay_s, 0.0))
    gap_s = now - max(one.held_at, one.refused_at)
    if gap_s > one.usual_gap_s:
        if gap_s > one.longest_gap_s * GAP_MARGIN:
            after_gap_s += max(delay_s - max(one.delay_s, after_gap_s), 0.0)
        one.longest_gap_s = max(gap_s, one.longest_gap_s)
        one.usual_gap_s = min(gap_s * GAP_MARGIN, BEGIN_ANEW_S)
    one.after_gap_s = after_gap_s


@kernel
def _belongs_to_claim(one, delay_s, now):
    """Whether a stamp that fits again goes on from those that were older.

    A clock was set back by so little that its stamps have caught up before they were believed:
    that is no delay. A single late sample is followed by one that is not late. One that comes after
    no more than the usual gap, with a usual delay, goes on from the held one.
    """
    is_usual_delay = -one.limit_s <= delay_s <= one.limit_s * USUAL_DELAY_SHARE
    if is_usual_delay and one.after_gap_s == 0.0 and now - one.held_at <= one.usual_gap_s:
        return False
    if one.claimed_at <= one.held_at or now - one.claimed_at > one.limit_s:
        return False
    claimed_s = one.claimed_s - fallen(one)
    return fallen_with(one, delay_s) - fallen(one) > claimed_s / 2.0


@kernel
def _step(one, delay_s, how):
    """Count the whole distance as the clock's."""
    one.new_delay_s = how
    one.new_forgiven_s = max(fallen_with(one, delay_s), 0.0)


@entry(STAMPS, int, float)
def hold_stamp(stamps, place, now):
    """Hold the sample of the input at ``place`` that was judged last; 1 when its clock was set."""
    one = stamps[place]
    is_step = one.new_delay_s < 0.0
    if is_step:
        if one.new_delay_s == STEPPED:
            if one.stamp_ns <= one.held_ns:
                one.steps_back += 1
            one.step_told_until = now + STEP_TOLD_S
        one.steps += 1
        one.forgiven_s = one.new_forgiven_s
        one.after_gap_s = 0.0
    one.delay_s = max(one.new_delay_s, 0.0)
    one.held_ns = one.stamp_ns
    one.held_at = now
    return 1 if is_step else 0


@entry(STAMPS, int)
def fade_gaps(stamps, place):
    """Let the longest gap be forgotten by and by, and the usual one looked at anew before."""
    one = stamps[place]
    one.usual_gap_s *= USUAL_GAP_FADES
    one.longest_gap_s *= LONGEST_GAP_FADES
    return 0
