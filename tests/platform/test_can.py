# SPDX-License-Identifier: Apache-2.0
"""CAN devices: what both backends promise, and the bytes that SocketCAN hands to the kernel."""

from __future__ import annotations

import errno
import socket
import struct
from collections.abc import Callable, Iterator

import pytest

from safety_island.platform import CanDevice, CanError, CanFrame, CanResult
from safety_island.platform.posix.can import SocketCan
from safety_island.platform.sim import make

FRAME = CanFrame(0x102, bytes([2, 0x0B, 42, 0, 0x39, 0x30, 0, 0]))

Open = tuple[CanDevice, Callable[[], list[CanFrame]]]


def over_a_socket_pair() -> tuple[SocketCan, socket.socket]:
    """A SocketCAN device whose kernel is the other end of a socket pair."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    theirs.setblocking(False)
    return SocketCan("can0", lambda interface: ours), theirs


@pytest.fixture(params=["posix", "sim"])
def device(request: pytest.FixtureRequest) -> Iterator[Open]:
    """A device that is not open yet, and what reads the frames that it sent."""
    if request.param == "sim":
        memory = make().new_can("can0")
        yield memory, lambda: [recorded.frame for recorded in memory.frames]
        return
    bus, kernel = over_a_socket_pair()

    def frames() -> list[CanFrame]:
        sent: list[CanFrame] = []
        while True:
            try:
                number, length, data = struct.unpack("=IB3x8s", kernel.recv(64))
            except BlockingIOError:
                return sent
            sent.append(CanFrame(number, data[:length]))

    yield bus, frames
    bus.close()
    kernel.close()


def test_frames_go_out_in_order(device: Open) -> None:
    bus, frames = device
    bus.open()
    sent = [FRAME, CanFrame(0x100, b"\x01\x02"), CanFrame(0x7FF, b"")]
    assert [bus.send(frame, 0.0) for frame in sent] == [CanResult.SENT] * 3
    assert frames() == sent


def test_a_device_that_is_not_open_sends_nothing(device: Open) -> None:
    bus, frames = device
    assert bus.send(FRAME, 0.0) is CanResult.NOT_OPEN
    bus.open()
    bus.close()
    bus.close()
    assert bus.send(FRAME, 0.0) is CanResult.NOT_OPEN
    assert frames() == []


def test_memory_device_meets_each_fault_once() -> None:
    bus = make().new_can("can0")
    bus.open()
    bus.faults += [CanResult.SENT, CanResult.BUS_OFF]
    results = [bus.send(FRAME, 0.0) for _ in range(3)]
    assert results == [CanResult.SENT, CanResult.BUS_OFF, CanResult.SENT]
    assert [recorded.time_ns for recorded in bus.frames] == [1000 * 10**9] * 2


def test_an_interface_that_cannot_be_opened_is_one_clear_error() -> None:
    with pytest.raises(CanError, match=r"CAN interface 'nosuchcan' cannot be opened \(.+\): see"):
        SocketCan("nosuchcan").open()


def test_a_bus_that_takes_nothing_costs_no_more_than_the_budget() -> None:
    bus, kernel = over_a_socket_pair()
    bus.open()
    results = {bus.send(FRAME, 0.0) for _ in range(10_000)}
    assert results == {CanResult.SENT, CanResult.TIMED_OUT}
    bus.close()
    kernel.close()


@pytest.mark.parametrize(
    ("code", "result"),
    [
        (errno.ENOBUFS, CanResult.QUEUE_FULL),
        (errno.ENETDOWN, CanResult.INTERFACE_DOWN),
        (errno.ENODEV, CanResult.INTERFACE_DOWN),
        (errno.EIO, CanResult.FAILED),
    ],
)
def test_what_the_kernel_says_becomes_a_result(code: int, result: CanResult) -> None:
    class Refusing(socket.socket):
        def send(self, data: object, flags: int = 0) -> int:
            raise OSError(code, "refused")

    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    bus = SocketCan("can0", lambda _: Refusing(fileno=ours.detach()))
    bus.open()
    assert bus.send(FRAME, 0.1) is result
    bus.close()
    theirs.close()
