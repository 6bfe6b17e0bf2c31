# SPDX-License-Identifier: Apache-2.0
"""What python-can sees of SocketCAN, where the kernel has none: sockets, a bus, error frames.

A socket pair stands for each raw CAN socket, so the bytes of ``struct can_frame``, waiting for
room, polling and the kernel's account of queued frames are real.

Not modelled: arbitration, the broadcast manager, drivers and their queues, network namespaces.
"""

from __future__ import annotations

import errno
import os
import select
import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from safety_island.platform.interfaces import CanFrame

FRAME = struct.Struct("=IB3x8s")
ERROR_FLAG = 0x2000_0000
_SO_TIMESTAMPNS = 35
_SOL_CAN_RAW, _CAN_RAW_FILTER, _CAN_RAW_ERR_FILTER = 101, 1, 2


class FakeSocket:
    """One raw CAN socket."""

    def __init__(self, kernel: FakeKernel) -> None:
        self._kernel = kernel
        self._ours, self.wire = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.filters: list[tuple[int, int]] = []
        self.error_mask = 0

    def bind(self, address: tuple[str]) -> None:
        """Join the bus, when there is one of that name."""
        if address[0] != self._kernel.channel:
            raise OSError(errno.ENODEV, os.strerror(errno.ENODEV))
        self._kernel.sockets.append(self)

    def setsockopt(self, level: int, option: int, value: int | bytes) -> None:
        """Note the filters; other options change nothing here."""
        if level == _SOL_CAN_RAW and option == _CAN_RAW_FILTER and isinstance(value, bytes):
            self.filters = list(struct.iter_unpack("=II", value))
        elif level == _SOL_CAN_RAW and option == _CAN_RAW_ERR_FILTER and isinstance(value, int):
            self.error_mask = value

    def getsockopt(self, level: int, option: int, size: int) -> bytes:
        """Ask the kernel's account of the socket pair."""
        return self._ours.getsockopt(level, option, size)

    def fileno(self) -> int:
        """For select."""
        return self._ours.fileno()

    def send(self, data: bytes) -> int:
        """Queue a frame, or fail as the interface does at present."""
        if self._kernel.fault:
            raise OSError(self._kernel.fault, os.strerror(self._kernel.fault))
        return self._ours.send(data)

    def recvmsg(self, size: int, ancillary: int) -> tuple[bytes, list[object], int, None]:
        """Return a frame with the time of its arrival."""
        data = self._ours.recv(size)
        stamp = struct.pack("@ll", 1_700_000_000, 0)
        return data, [(socket.SOL_SOCKET, _SO_TIMESTAMPNS, stamp)], 0, None

    def takes(self, identifier: int) -> bool:
        """Whether the filters let a frame pass."""
        if identifier & ERROR_FLAG:
            return bool(identifier & self.error_mask & ~ERROR_FLAG)
        return any((identifier ^ wanted) & mask == 0 for wanted, mask in self.filters)

    def close(self) -> None:
        """Leave the bus. What the bus has not taken yet is lost here; a real kernel keeps it."""
        if self in self._kernel.sockets:
            self._kernel.sockets.remove(self)
        self._ours.close()
        self.wire.close()


class FakeKernel:
    """One CAN interface. Frames travel when ``run`` is called; until then they are queued."""

    def __init__(self, channel: str = "can0") -> None:
        self.channel = channel
        self.sockets: list[FakeSocket] = []
        self.frames: list[CanFrame] = []
        """What the bus carried."""
        self.fault = 0
        """The error number that sending meets, 0 for none."""

    def run(self) -> None:
        """Let the queued frames travel."""
        while ready := select.select([s.wire for s in self.sockets], [], [], 0)[0]:
            for wire in ready:
                data = wire.recv(FRAME.size)
                identifier, length, content = FRAME.unpack(data)
                self.frames.append(CanFrame(identifier, content[:length]))
                self._spread(identifier, data, wire)

    def emit(self, identifier: int, data: bytes) -> None:
        """Let another node, or the controller itself, make a frame."""
        packed = FRAME.pack(identifier, len(data), data)
        self._spread(identifier, packed, None)

    def _spread(self, identifier: int, data: bytes, source: socket.socket | None) -> None:
        for receiver in self.sockets:
            if receiver.wire is not source and receiver.takes(identifier):
                receiver.wire.send(data)


@contextmanager
def fake_socketcan(patch: pytest.MonkeyPatch, channel: str = "can0") -> Iterator[FakeKernel]:
    """Let python-can's SocketCAN find a fake kernel."""
    kernel = FakeKernel(channel)
    made: list[FakeSocket] = []

    def create() -> FakeSocket:
        made.append(FakeSocket(kernel))
        return made[-1]

    patch.setattr("can.interfaces.socketcan.socketcan.create_socket", create)
    yield kernel
    for left in made:
        left.close()
