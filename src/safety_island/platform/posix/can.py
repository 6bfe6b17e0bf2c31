# SPDX-License-Identifier: Apache-2.0
"""SocketCAN through the standard library."""

from __future__ import annotations

import errno
import select
import socket
import struct
from collections.abc import Callable

from safety_island.platform.interfaces import CanError, CanFrame, CanResult

FRAME = struct.Struct("=IB3x8s")
"""``struct can_frame`` of ``linux/can.h``: identifier, length, padding, data."""

_CAUSES = {
    errno.ENOBUFS: CanResult.QUEUE_FULL,
    errno.ENETDOWN: CanResult.INTERFACE_DOWN,
    errno.ENETUNREACH: CanResult.INTERFACE_DOWN,
    errno.ENODEV: CanResult.INTERFACE_DOWN,
    errno.ENXIO: CanResult.INTERFACE_DOWN,
}


def connect(interface: str) -> socket.socket:
    """Return a raw CAN socket bound to the interface. Raises OSError."""
    bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    try:
        bus.bind((interface,))
    except OSError:
        bus.close()
        raise
    return bus


class SocketCan:
    """A SocketCAN interface that frames are sent with; ``connection`` makes the socket."""

    def __init__(
        self, interface: str, connection: Callable[[str], socket.socket] = connect
    ) -> None:
        self.interface = interface
        self._connection = connection
        self._bus: socket.socket | None = None

    def open(self) -> None:
        """Open the interface. Raises CanError."""
        try:
            self._bus = self._connection(self.interface)
        except (OSError, AttributeError) as error:
            raise CanError(
                f"CAN interface '{self.interface}' cannot be opened ({error}): "
                "see 'ip -details link show type can' for the interfaces of this machine"
            ) from error
        self._bus.setblocking(False)

    def send(self, frame: CanFrame, budget_s: float) -> CanResult:
        """Hand a frame to the kernel, waiting at most ``budget_s`` for room."""
        if self._bus is None:
            return CanResult.NOT_OPEN
        packed = FRAME.pack(frame.arbitration_id, len(frame.data), frame.data)
        try:
            if not select.select((), (self._bus,), (), budget_s)[1]:
                return CanResult.TIMED_OUT
            self._bus.send(packed)
        except BlockingIOError:
            return CanResult.TIMED_OUT
        except OSError as error:
            return _CAUSES.get(error.errno or 0, CanResult.FAILED)
        return CanResult.SENT

    def close(self) -> None:
        """Close the socket."""
        if self._bus is not None:
            self._bus.close()
            self._bus = None
