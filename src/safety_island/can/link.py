# SPDX-License-Identifier: Apache-2.0
"""The straight way to a device."""

from __future__ import annotations

from collections.abc import Sequence

from safety_island.can.bus import BusDevice, BusEvent, Delivery, MonotonicNs, deliver
from safety_island.platform.interfaces import CanError, CanFrame


class DirectLink:
    """For a device whose ``send`` keeps to its budget and whose ``open`` is quick."""

    is_opening = False

    def __init__(self, device: BusDevice, clock: MonotonicNs) -> None:
        self.device = device
        self._clock = clock

    def open(self) -> None:
        """Open the device. Raises CanError."""
        self.device.open()

    def send(self, frames: Sequence[CanFrame], budget_s: float) -> Delivery:
        """Deliver the frames within the budget [s]."""
        return deliver(self.device, frames, self._clock() + int(budget_s * 1e9), self._clock)

    def poll(self) -> Sequence[BusEvent]:
        """Return what happened on the bus."""
        return self.device.poll()

    def discard(self) -> None:
        """Throw away what waits to be sent."""
        self.device.discard()

    def reopen(self) -> None:
        """Close and open again; when that fails, ``send`` finds the device closed."""
        renew(self.device)

    def close(self) -> None:
        """Close the device."""
        self.device.close()


def renew(device: BusDevice) -> bool:
    """Close a device, throwing away what waits, and open it again; tell whether it is open."""
    device.discard()
    device.close()
    try:
        device.open()
    except CanError:
        return False
    return True
