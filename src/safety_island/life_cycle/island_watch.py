# SPDX-License-Identifier: Apache-2.0
"""Whether another island is on the domain, and which of the two was there first."""

from __future__ import annotations


class IslandWatch:
    """Publishers of the control command that are not ours; times in s, monotonic.

    Whoever finds another one while it still looks around is the newcomer, and does not arm as long
    as that one lives. Two that start at the same moment both wait, until one is stopped.
    """

    def __init__(self, joined_at: float, discovery_s: float) -> None:
        self.others: frozenset[bytes] = frozenset()
        self._ready_at = joined_at + discovery_s
        self._earlier: frozenset[bytes] | None = None

    def update(self, others: frozenset[bytes], now: float) -> None:
        """Note which other publishers live now (GUIDs)."""
        self.others = others
        if now <= self._ready_at or self._earlier is None:  # a first look may come late
            self._earlier = others
        else:
            self._earlier &= others

    def looks_around(self, now: float) -> bool:
        """Whether it is too early to say that there is no other."""
        return now < self._ready_at

    @property
    def is_newcomer(self) -> bool:
        """Whether one that was there before still lives."""
        return bool(self._earlier)
