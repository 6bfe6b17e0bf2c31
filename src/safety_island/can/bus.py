# SPDX-License-Identifier: Apache-2.0
"""What CAN output needs of a bus: an open device, its events, and the delivery of a triple."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import StrEnum
from typing import NamedTuple, Protocol

from safety_island.platform.interfaces import CanDevice, CanFrame, CanResult

MonotonicNs = Callable[[], int]
"""A monotonic clock [ns]."""


class EventKind(StrEnum):
    """What a bus tells besides frames that concern nobody here."""

    BUS_OFF = "bus_off"
    ERROR_PASSIVE = "error_passive"
    ERROR_WARNING = "error_warning"
    ERROR_ACTIVE = "error_active"
    RESTARTED = "restarted"
    NOT_ACKNOWLEDGED = "not_acknowledged"
    OVERFLOW = "overflow"
    FOREIGN_COMMAND = "foreign_command"
    """Another node sends a frame with one of our identifiers."""


class BusEvent(NamedTuple):
    """One event; the identifier is that of a foreign frame, else 0."""

    kind: EventKind
    arbitration_id: int = 0


class BusDevice(CanDevice, Protocol):
    """A CAN device of the platform that also tells what happens on the bus."""

    def poll(self) -> Sequence[BusEvent]:
        """Return what happened since the last call, without waiting."""

    def discard(self) -> None:
        """Throw away what waits to be sent, as far as the device can."""


class Delivery(NamedTuple):
    """What became of the frames of one command."""

    sent: int
    """How many of them, from the first on, were handed over."""
    result: CanResult
    """``SENT`` only when all were."""
    events: Sequence[BusEvent] = ()


def deliver(
    device: BusDevice,
    frames: Sequence[CanFrame],
    deadline_ns: int,
    clock: MonotonicNs,
    may_go_on: Callable[[int], bool] = lambda index: True,
) -> Delivery:
    """Hand over all frames before the deadline; stop at the first that fails.

    A bus that reports that it is off gets no frame. ``may_go_on`` is asked before each frame, by
    its index.
    """
    events = device.poll()
    if any(event.kind is EventKind.BUS_OFF for event in events):
        return Delivery(0, CanResult.BUS_OFF, events)
    for index, frame in enumerate(frames):
        left_ns = deadline_ns - clock()
        if left_ns <= 0 or not may_go_on(index):
            return Delivery(index, CanResult.TIMED_OUT, events)
        result = device.send(frame, left_ns / 1e9)
        if result is not CanResult.SENT:
            return Delivery(index, result, events)
    return Delivery(len(frames), CanResult.SENT, events)


class BusLink(Protocol):
    """The way from the control loop to a device, bounded in time."""

    def open(self) -> None:
        """Make the device ready; may take seconds. Raises CanError."""

    def send(self, frames: Sequence[CanFrame], budget_s: float) -> Delivery:
        """Deliver the frames of one command within the budget [s], or give up."""

    def poll(self) -> Sequence[BusEvent]:
        """Return what happened since the last call or delivery; never waits."""

    def discard(self) -> None:
        """Throw away what waits to be sent."""

    def reopen(self) -> None:
        """Close the device, throwing away what waits, and open it again; never waits.

        ``send`` returns ``NOT_OPEN`` until that has succeeded.
        """

    @property
    def is_opening(self) -> bool:
        """Whether a reopening is under way."""

    def close(self) -> None:
        """Give the device back."""
