# SPDX-License-Identifier: Apache-2.0
"""The publishers of one topic: to which one the island keeps, and how often they change."""

from __future__ import annotations

from collections import deque

WINDOW_S = 1.0
"""Time [s] within which changes of a publisher are counted."""

MOST_OTHERS = 255
"""Publishers beside the owner that are counted: what one byte of the status holds."""

UNKNOWN = bytes(16)
"""GUID of a publisher that was gone before its sample was looked at."""


class Writers:
    """Publishers by their GUIDs (16 bytes), as discovery tells them; times in s, monotonic.

    ``owner`` is the one whose samples are taken: the first, as long as it lives; empty when none
    is known. ``others`` counts the rest. ``limit`` changes within WINDOW_S are flapping.
    """

    def __init__(self, limit: int) -> None:
        self.owner = b""
        self.others = 0
        self.alive: frozenset[bytes] = frozenset()
        self._appeared: deque[float] = deque(maxlen=limit)
        self._has_seen_one = False

    def update(self, alive: frozenset[bytes], now: float) -> None:
        """Note which publishers live now."""
        new = len(alive - self.alive) - (not self._has_seen_one)
        self._has_seen_one = self._has_seen_one or bool(alive)
        self._appeared.extend([now] * new)
        self.alive = alive
        if self.owner not in alive:
            self.owner = b""
        self.others = min(len(alive) - bool(alive), MOST_OTHERS)

    def takes(self, guid: bytes) -> bool:
        """Whether a sample of this publisher is taken; the first one becomes the owner.

        One that is gone already owns nothing, and is not taken while an owner lives.
        """
        if guid == self.owner:
            return True
        if self.owner in self.alive:
            return False
        if guid != UNKNOWN:
            self.owner = guid
        return True

    def changed(self, now: float) -> bool:
        """Whether a publisher appeared within the last second, after the first one."""
        return bool(self._appeared) and now - self._appeared[-1] <= WINDOW_S

    def flaps(self, now: float) -> bool:
        """Whether publishers came and went too often within the last second."""
        times = self._appeared
        return len(times) == times.maxlen and now - times[0] <= WINDOW_S
