# SPDX-License-Identifier: Apache-2.0
"""Tells a sender whose clock was set from samples that arrive late: stamps of a clock advance.

Looks at stamps that do not fit what is held. The search begins anew with a stamp that does not
advance, after a gap of the age limit, and when a stamp has fitted.
"""

from safety_island.kernel.kernel import kernel

SEARCH_SHARE = 0.5
"""Share of the age limit for which stamps that do not fit must keep advancing until they count as
a clock (set back, or a successor's) rather than as samples that were overtaken or held up."""


@kernel
def goes_on(one, now):
    """Whether the stamp of ``now`` advanced from one of an earlier tick."""
    return one.seen_at == now and one.since < now


@kernel
def finds(one, now):
    """Whether stamps have advanced for long enough, up to the one that is judged."""
    is_first = now > one.seen_at  # of one tick the newest comes first, and it alone tells
    is_gap = now - one.seen_at > one.limit_s
    begins = is_first and (one.stamp_ns <= one.seen_ns or is_gap)
    if begins or one.held_at >= one.seen_at:
        one.since = now
    if is_first:
        one.seen_ns = one.stamp_ns
        one.seen_at = now
    return now - one.since >= one.limit_s * SEARCH_SHARE
