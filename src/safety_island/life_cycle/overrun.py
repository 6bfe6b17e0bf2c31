# SPDX-License-Identifier: Apache-2.0
"""Whether the ticks come in time."""

from safety_island.kernel.kernel import kernel


@kernel
def note_tick(p, o, now, skipped):
    """Note a tick at ``now`` [s, monotonic], before which ``skipped`` were missed.

    ``degraded``: ticks in a row were late, or the mean period is too long; ``over``: that has gone
    on for too many ticks, and the output must end.
    """
    size = p.overrun_window + 1
    o.times[o.next] = now
    o.next = o.next + 1 if o.next + 1 < size else 0
    o.n = min(o.n + 1, size)
    o.in_row = o.in_row + 1 if skipped > 0 else 0
    o.degraded = o.in_row >= p.overrun_ticks or is_slow(p, o, now)
    o.degraded_for = o.degraded_for + 1 if o.degraded else 0
    o.over = o.degraded_for > p.overrun_ticks


@kernel
def is_slow(p, o, now):
    """Whether the mean period of a whole window is too long."""
    longest_s = p.period_s / p.overrun_ratio * p.overrun_window
    return o.n > p.overrun_window and now - o.times[o.next] > longest_s


@kernel
def forget_overrun(o):
    """Begin anew."""
    o.n = 0
    o.in_row = 0
    o.degraded_for = 0
    o.degraded = False
    o.over = False
