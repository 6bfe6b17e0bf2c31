# SPDX-License-Identifier: Apache-2.0
"""A CAN device that records its frames."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from safety_island.platform.interfaces import CanFrame, CanResult, Clock

CAPACITY = 65536


class Recorded(NamedTuple):
    """A frame that was sent, with its monotonic time [ns]."""

    time_ns: int
    frame: CanFrame


class MemoryCan:
    """Keeps the newest frames in ``frames``; each result waiting in ``faults`` meets one frame.

    Not modelled: arbitration, bit rate and transmission time, acknowledgement, error counters,
    receive, and other nodes.
    """

    def __init__(self, clock: Clock, interface: str) -> None:
        self.interface = interface
        self.frames: deque[Recorded] = deque(maxlen=CAPACITY)
        self.faults: deque[CanResult] = deque()
        self._clock = clock
        self._is_open = False

    def open(self) -> None:
        """Always possible."""
        self._is_open = True

    def send(self, frame: CanFrame, budget_s: float) -> CanResult:
        """Record a frame, or return the next fault; takes no time."""
        if not self._is_open:
            return CanResult.NOT_OPEN
        if self.faults and (fault := self.faults.popleft()) is not CanResult.SENT:
            return fault
        self.frames.append(Recorded(self._clock.monotonic_ns(), frame))
        return CanResult.SENT

    def close(self) -> None:
        """Later frames find the device closed."""
        self._is_open = False
