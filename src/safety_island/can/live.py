# SPDX-License-Identifier: Apache-2.0
"""A live bus as a stream of entries, and a command sent to it by hand."""

from __future__ import annotations

from collections.abc import Generator, Sequence

from safety_island.can.backends import find_backend, new_link
from safety_island.can.bus import MonotonicNs
from safety_island.can.candump import LogEntry
from safety_island.can.spec import BusSpec
from safety_island.errors import ConfigurationError
from safety_island.platform.interfaces import CanError, CanFrame, CanResult

SEND_LIMIT_S = 1.0
"""A user at the keyboard can wait that long."""
_WAIT_S = 0.1


def watch(spec: BusSpec) -> Generator[LogEntry | None]:
    """Yield what comes in on a bus, and None when nothing came for a tenth of a second.

    Raises ConfigurationError and CanError.
    """
    backend = find_backend(spec.backend)
    if backend.name == "mock":
        raise ConfigurationError("--can mock: the mock bus has nobody to listen to, expected a bus")
    from safety_island.can.python_can_bus import check_spec, close_bus, next_entry, open_bus

    check_spec(spec, backend.example)
    bus = open_bus(spec)
    try:
        while True:
            yield next_entry(bus, spec, _WAIT_S)
    finally:
        close_bus(bus)


def send_once(spec: BusSpec, frames: Sequence[CanFrame], clock: MonotonicNs) -> None:
    """Send the frames of one command. Raises ConfigurationError and CanError."""
    link = new_link(spec, clock)
    try:
        link.open()
        delivery = link.send(frames, SEND_LIMIT_S)
    finally:
        link.close()
    if delivery.result is not CanResult.SENT:
        failed = frames[delivery.sent]
        raise CanError(
            f"CAN bus '{spec}' did not take frame 0x{failed.arbitration_id:03X}: "
            f"{delivery.result.name.lower().replace('_', ' ')}; "
            f"{delivery.sent} of {len(frames)} frames were sent"
        )
