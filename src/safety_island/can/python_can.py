# SPDX-License-Identifier: Apache-2.0
"""Every CAN backend but the mock, through python-can."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any

import can

from safety_island.can.bus import BusEvent, EventKind, MonotonicNs
from safety_island.can.bus_errors import events_of, result_of
from safety_island.can.python_can_bus import check_spec, close_bus, discard_output, open_bus
from safety_island.can.socketcan import COMMAND_FILTERS, is_held_back, refuse_without_carrier
from safety_island.can.spec import Backend, BusSpec
from safety_island.command.frames import FRAMES, WATCHED_IDS
from safety_island.platform.interfaces import CanError, CanFrame, CanResult

POLL_LIMIT = 256
"""Frames that one poll reads at most; the rest waits for the next."""
_FIRST_ID = FRAMES[0].arbitration_id
_ECHOES_KEPT = 4 * len(FRAMES)

_STATES = {
    can.BusState.PASSIVE: EventKind.ERROR_PASSIVE,
    can.BusState.ERROR: EventKind.BUS_OFF,
}


class PythonCanDevice:
    """A bus of python-can behind the interface of the platform, with its events."""

    def __init__(self, spec: BusSpec, backend: Backend, clock: MonotonicNs) -> None:
        self.spec = spec
        self._backend = backend
        self._clock = clock
        self._bus: can.BusABC | None = None
        self._draining: can.BusABC | None = None
        self._sent: deque[CanFrame] = deque(maxlen=_ECHOES_KEPT)

    def open(self) -> None:
        """Open the bus. Raises CanError, also while the kernel holds frames of an older command.

        The kernel keeps a frame when its socket is closed. Were a new one opened, commands would
        pile up behind a bus that stands still, and all leave when it moves again.
        """
        if self._backend.kernel_queue:
            refuse_without_carrier(self.spec.channel)
        if self._is_held_back(self._draining):
            raise CanError(f"CAN bus '{self.spec}' still holds frames of an older command")
        if self._draining is not None:
            close_bus(self._draining)
            self._draining = None
        self._bus = open_bus(self.spec, **_defaults(self._backend))

    def send(self, frame: CanFrame, budget_s: float) -> CanResult:
        """Hand a frame to the driver, asking it to wait at most ``budget_s``.

        A new command is not begun while the kernel holds frames of an older one.
        """
        if self._bus is None:
            return CanResult.NOT_OPEN
        if frame.arbitration_id == _FIRST_ID and self._is_held_back(self._bus):
            return CanResult.QUEUE_FULL
        message = can.Message(
            arbitration_id=frame.arbitration_id, data=frame.data, is_extended_id=False
        )
        deadline_ns = self._clock() + int(budget_s * 1e9)
        try:
            self._bus.send(message, timeout=budget_s)
        except Exception as error:  # each driver has exceptions of its own
            return result_of(error, self._clock() >= deadline_ns)
        self._sent.append(frame)
        return CanResult.SENT

    def poll(self) -> Sequence[BusEvent]:
        """Return error frames, the controller's state, and foreign frames with our identifiers."""
        if self._bus is None:
            return ()
        events: list[BusEvent] = []
        silent = 0
        try:
            for _ in range(POLL_LIMIT):
                message = self._bus.recv(timeout=0)
                silent = 0 if message else silent + 1
                if message:
                    events += self._events(message)
                elif silent == self._backend.silent_reads:
                    break
            if kind := _STATES.get(self._bus.state):
                events.append(BusEvent(kind))
        except Exception:  # a bus that cannot be read shows its cause when it is written to
            return events
        return events

    def discard(self) -> None:
        """Throw away what waits to be sent, as far as the driver can."""
        if self._bus is not None:
            discard_output(self._bus, self.spec)

    def close(self) -> None:
        """Close the bus; a second call does nothing."""
        bus, self._bus = self._bus, None
        self._sent.clear()
        if self._is_held_back(bus):
            self._draining = bus
        elif bus is not None:
            close_bus(bus)

    def _events(self, message: can.Message) -> list[BusEvent]:
        if message.is_error_frame:
            return events_of(message)
        if message.is_extended_id or message.arbitration_id not in WATCHED_IDS:
            return []
        if self._backend.echoes:
            frame = CanFrame(message.arbitration_id, bytes(message.data))
            if frame in self._sent:
                self._sent.remove(frame)
                return []
        return [BusEvent(EventKind.FOREIGN_COMMAND, message.arbitration_id)]

    def _is_held_back(self, bus: Any) -> bool:
        return bus is not None and self._backend.kernel_queue and is_held_back(bus.socket)


def _defaults(backend: Backend) -> dict[str, Any]:
    if backend.kernel_queue:
        return {"can_filters": COMMAND_FILTERS}
    # A read of the serial line must not wait: the line is polled.
    return {"timeout": 0.0} if backend.name == "slcan" else {}


def new_device(spec: BusSpec, backend: Backend, clock: MonotonicNs) -> PythonCanDevice:
    """Return the device, not yet open. Raises ConfigurationError."""
    check_spec(spec, backend.example)
    return PythonCanDevice(spec, backend, clock)
