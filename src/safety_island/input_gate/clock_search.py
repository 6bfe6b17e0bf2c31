# SPDX-License-Identifier: Apache-2.0
"""Tells a sender whose clock was set from samples that arrive late: stamps of a clock advance."""

from __future__ import annotations

import math

SEARCH_SHARE = 0.5
"""Share of the age limit for which stamps that do not fit must keep advancing until they count as
a clock (set back, or a successor's) rather than as samples that were overtaken or held up."""


class ClockSearch:
    """Looks at stamps that do not fit what is held; told the time [s, monotonic].

    It begins anew with a stamp that does not advance, after a gap of the age limit [s], and when a
    stamp has fitted.
    """

    def __init__(self, limit_s: float) -> None:
        self._seen_at = -math.inf
        self._limit_s = limit_s
        self._stamp_ns = 0
        self._since = 0.0

    def goes_on(self, now: float) -> bool:
        """Whether the stamp of ``now`` advanced from one of an earlier tick."""
        return self._seen_at == now and self._since < now

    def finds(self, stamp_ns: int, now: float, fitted_at: float) -> bool:
        """Whether stamps have advanced for long enough, up to this one.

        ``fitted_at`` [s]: when the last one that did fit came.
        """
        is_first = now > self._seen_at  # of one tick the newest comes first, and it alone tells
        begins = is_first and (stamp_ns <= self._stamp_ns or now - self._seen_at > self._limit_s)
        if begins or fitted_at >= self._seen_at:
            self._since = now
        if is_first:
            self._stamp_ns, self._seen_at = stamp_ns, now
        return now - self._since >= self._limit_s * SEARCH_SHARE
