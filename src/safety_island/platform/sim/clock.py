# SPDX-License-Identifier: Apache-2.0
"""Virtual time: it moves only when a timer waits or a test says so."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from itertools import count

START_NS = 1000 * 1_000_000_000
"""Not zero: a stamp of zero means "unset" to many programs."""


class SimClock:
    """A clock that is moved by hand, with actions that happen on the way.

    The wall clock is the monotonic one plus an offset, 0 at first. It models no drift, no
    resolution and no time that passes while code runs (except where an action advances it).
    """

    def __init__(self, start_ns: int = START_NS) -> None:
        self._now_ns = start_ns
        self._offset_ns = 0
        self._slept_ns = 0
        self._actions: list[tuple[int, int, Callable[[], None]]] = []
        self._order = count()

    def monotonic_ns(self) -> int:
        """Virtual time [ns]."""
        return self._now_ns

    def wall_ns(self) -> int:
        """Virtual time [ns] plus the wall offset."""
        return self._now_ns + self._offset_ns

    def now(self) -> float:
        """Virtual wall clock [s]."""
        return self.wall_ns() / 1e9

    def slept_ns(self) -> int:
        """Time [ns] that ``sleep_ns`` made up."""
        return self._slept_ns

    def sleep_ns(self, duration_ns: int) -> None:
        """Suspend the machine: only the wall clock goes on."""
        self._slept_ns += duration_ns
        self._offset_ns += duration_ns

    def set_wall_offset_ns(self, offset_ns: int | None) -> None:
        """Let the wall clock be the monotonic one plus this; None: plus nothing."""
        self._offset_ns = offset_ns or 0

    def call_at(self, time_ns: int, action: Callable[[], None]) -> None:
        """Call ``action`` when the time is reached; actions of one time in the order of the calls.

        A time that has passed means: at the next advance.
        """
        heapq.heappush(self._actions, (time_ns, next(self._order), action))

    def advance_to_ns(self, time_ns: int) -> None:
        """Move on to a time, doing on the way what is to be done; a time that passed does nothing.

        An action may itself move the clock (a computation that takes long) or set new actions.
        """
        while self._actions and self._actions[0][0] <= time_ns:
            due_ns, _, action = heapq.heappop(self._actions)
            self._now_ns = max(self._now_ns, due_ns)
            action()
        self._now_ns = max(self._now_ns, time_ns)
