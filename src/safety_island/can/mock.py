# SPDX-License-Identifier: Apache-2.0
"""An in-memory bus: a full backend of the production command, and the fake of the tests."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from safety_island.can.bus import BusEvent, MonotonicNs
from safety_island.can.spec import Backend, BusSpec
from safety_island.platform.interfaces import CanError, CanFrame, CanResult

CAPACITY = 65536


class MockBus:
    """Records the newest frames in ``frames``.

    For tests: ``faults`` holds results that the next frames meet one by one (``SENT`` lets one
    pass), ``refusals`` counts how often ``open`` still fails, ``tell`` makes an event.

    Not modelled: arbitration, bit rate and transmission time (sending takes none), acknowledgement,
    error counters and the bus-off state machine, a transmit queue, frames of other nodes.
    """

    def __init__(self) -> None:
        self.frames: deque[CanFrame] = deque(maxlen=CAPACITY)
        self.faults: deque[CanResult] = deque()
        self.refusals = 0
        self.opened = 0
        self.discarded = 0
        self._events: list[BusEvent] = []
        self._is_open = False

    def open(self) -> None:
        """Succeed, unless a refusal is left. Raises CanError."""
        if self.refusals:
            self.refusals -= 1
            raise CanError("the mock CAN bus was told to refuse")
        self.opened += 1
        self._is_open = True

    def send(self, frame: CanFrame, budget_s: float) -> CanResult:
        """Record a frame, or return the next fault."""
        if not self._is_open:
            return CanResult.NOT_OPEN
        if self.faults and (fault := self.faults.popleft()) is not CanResult.SENT:
            return fault
        self.frames.append(frame)
        return CanResult.SENT

    def tell(self, event: BusEvent) -> None:
        """Let the next ``poll`` return an event."""
        self._events.append(event)

    def poll(self) -> Sequence[BusEvent]:
        """Return the events that were told."""
        if not self._events:
            return ()
        events, self._events = self._events, []
        return events

    def discard(self) -> None:
        """Count the call: nothing ever waits here."""
        self.discarded += 1

    def close(self) -> None:
        """Later frames find the bus closed."""
        self._is_open = False


def new_device(spec: BusSpec, backend: Backend, clock: MonotonicNs) -> MockBus:
    """Return the device; the mock takes no channel and no option."""
    spec.refuse_channel()
    spec.refuse_options(())
    return MockBus()
