# SPDX-License-Identifier: Apache-2.0
"""What CAN output says, once for each trouble, and once when it is over."""

from __future__ import annotations

from safety_island.can.bus import BusEvent, EventKind
from safety_island.can.command import Cause
from safety_island.can.encoder import Rejection
from safety_island.platform.interfaces import Logger

_CAUSES = {
    Cause.QUEUE_FULL: "the transmit queue is full (is any other node there to acknowledge?)",
    Cause.TIMED_OUT: "the bus did not take it within a tenth of the period",
    Cause.BUS_OFF: "the controller is off the bus (check wiring, termination and bit rate)",
    Cause.INTERFACE_DOWN: "the interface is down",
    Cause.NOT_OPEN: "the bus is not open",
    Cause.FAILED: "the driver refused it",
}
_EVENTS = {
    EventKind.ERROR_PASSIVE: "the CAN controller is error-passive: many frames fail",
    EventKind.ERROR_WARNING: "the CAN controller warns: its error counters passed 96",
    EventKind.NOT_ACKNOWLEDGED: "no node acknowledges our CAN frames",
    EventKind.OVERFLOW: "the CAN controller lost frames: a buffer overflowed",
}
_OVER = (EventKind.ERROR_ACTIVE, EventKind.RESTARTED)


class OutputLog:
    """Remembers what was said, so that a trouble that lasts is one line and not one each tick."""

    def __init__(self, logger: Logger) -> None:
        self._logger = logger
        self._failures = 0
        self._rejections = 0
        self._causes: set[Cause] = set()
        self._events: set[BusEvent] = set()
        self._foreign: set[BusEvent] = set()

    def sent(self) -> None:
        """A command went out: what was wrong is over."""
        if self._causes:
            self._logger.info("CAN output works again, after %d failed commands", self._failures)
            self._causes.clear()
            self._failures = 0
        if self._rejections:
            self._logger.info("CAN commands are valid again, after %d rejected", self._rejections)
            self._rejections = 0

    def rejected(self, rejection: Rejection) -> None:
        """A command has a value that no frame can carry."""
        self._rejections += 1
        if self._rejections == 1:
            self._logger.error("CAN command rejected, nothing sent: %s", rejection.describe())

    def failed(self, arbitration_id: int, cause: Cause) -> None:
        """A frame of a command was not sent."""
        self._failures += 1
        if cause not in self._causes:
            self._causes.add(cause)
            self._logger.error(
                "CAN command not sent, frame 0x%03X: %s", arbitration_id, _CAUSES[cause]
            )

    def not_open(self, reason: str) -> None:
        """The bus could not be opened at the start; DDS goes on."""
        self._causes.add(Cause.NOT_OPEN)
        self._logger.error("%s; commands go out over DDS alone", reason)

    def event(self, event: BusEvent) -> None:
        """The bus told something."""
        if event.kind in _OVER:
            self._events.clear()
            self._logger.info("CAN controller: %s", event.kind.replace("_", " "))
            return
        if event in self._events or event in self._foreign or event.kind is EventKind.BUS_OFF:
            return  # bus-off is told as the cause of the command that it stopped
        if event.kind is EventKind.FOREIGN_COMMAND:
            self._foreign.add(event)
            self._logger.error(
                "another node sends our CAN frame 0x%03X: two masters on one bus",
                event.arbitration_id,
                throttled=True,
                site=f"CAN foreign {event.arbitration_id:03X}",
            )
        else:
            self._events.add(event)
            self._logger.warning(_EVENTS[event.kind])

    def nothing_foreign(self) -> None:
        """No other node sends our frames."""
        if self._foreign:
            self._foreign.clear()
            text = "no other node sends our CAN frames any more"
            self._logger.info(text, throttled=True)
