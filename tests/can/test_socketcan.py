# SPDX-License-Identifier: Apache-2.0
"""SocketCAN through python-can, over the fake kernel: error frames, full queue, interface down."""

from __future__ import annotations

import errno
import socket
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from safety_island.can.backends import new_link
from safety_island.can.bus import EventKind
from safety_island.can.command import Cause
from safety_island.can.output import CanOutput
from safety_island.can.socketcan import is_held_back, refuse_without_carrier
from safety_island.can.spec import BusSpec
from safety_island.command.mode import OutputMode
from safety_island.platform.interfaces import CanError
from tests.can.fake_socketcan import ERROR_FLAG, FakeKernel, fake_socketcan
from tests.can.rig import REFERENCE, FakeClock, LogLines

SPEC = BusSpec("socketcan", "can0")
PERIOD_S = 0.15


@pytest.fixture
def kernel(monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeKernel]:
    with fake_socketcan(monkeypatch) as made:
        yield made


class Bench:
    """An output over the fake kernel; a tick sends a command and lets the frames travel."""

    def __init__(self, kernel: FakeKernel) -> None:
        self.kernel = kernel
        self.log = LogLines()
        self.clock = FakeClock()
        link = new_link(SPEC, time.monotonic_ns)
        link.open()
        self.output = CanOutput(OutputMode.DDS_AND_CAN, link, 0.015, self.clock, self.log)

    def tick(self, travel: bool = True) -> Cause | None:
        self.output.send(REFERENCE, self.clock.now_ns)
        self.clock.advance(PERIOD_S)
        if travel:
            self.kernel.run()
        assert self.output.last is not None
        return self.output.last.cause

    def sequences(self) -> list[int]:
        """Return the numbers of the status frames on the bus."""
        frames = [f for f in self.kernel.frames if f.arbitration_id == 0x102]
        return [int.from_bytes(frame.data[2:4], "little") for frame in frames]


@pytest.fixture
def bench(kernel: FakeKernel) -> Iterator[Bench]:
    made = Bench(kernel)
    yield made
    made.output.close()


def test_only_own_identifiers_and_errors_pass_the_filters(bench: Bench) -> None:
    (raw,) = bench.kernel.sockets
    taken = [i for i in range(0x800) if raw.takes(i)]
    assert taken == [0x100, 0x101, 0x102, 0x103]
    assert raw.takes(ERROR_FLAG | 0x40)


def test_bus_off_stops_the_next_command(bench: Bench) -> None:
    assert bench.tick() is None
    bench.kernel.emit(ERROR_FLAG | 0x40, bytes(8))
    assert bench.tick() is Cause.BUS_OFF
    assert bench.tick() is None
    assert bench.sequences() == [0, 2]
    assert bench.output.counters.events[EventKind.BUS_OFF] == 1


def test_error_passive_is_told_and_sent_through(bench: Bench) -> None:
    bench.kernel.emit(ERROR_FLAG | 0x04, bytes([0, 0x20, 0, 0, 0, 0, 0, 0]))
    assert bench.tick() is None
    assert bench.output.counters.events[EventKind.ERROR_PASSIVE] == 1


@pytest.mark.parametrize(
    ("number", "cause"),
    [(errno.ENOBUFS, Cause.QUEUE_FULL), (errno.ENETDOWN, Cause.INTERFACE_DOWN)],
)
def test_what_the_kernel_refuses_is_counted_by_cause(
    bench: Bench, number: int, cause: Cause
) -> None:
    bench.kernel.fault = number
    assert bench.tick() is cause
    assert bench.tick() is cause
    bench.kernel.fault = 0
    assert [bench.tick() for _ in range(4)][-1] is None
    assert bench.output.counters.frames == {(0x100, cause): bench.output.counters.failed}


def test_behind_a_bus_that_stands_still_one_command_waits_and_no_more(bench: Bench) -> None:
    """Otherwise old commands would pile up in the kernel, and leave when the bus moves again."""
    assert bench.tick(travel=False) is None
    causes = [bench.tick(travel=False) for _ in range(100)]
    assert causes[0] is Cause.QUEUE_FULL
    assert None not in causes
    bench.kernel.run()
    assert bench.sequences() == [0]
    causes = [bench.tick() for _ in range(40)]
    back = causes.index(None)
    assert set(causes[back:]) == {None}
    assert bench.sequences() == [0, *range(101 + back, 141)]


def test_an_interface_that_is_gone_cannot_be_opened(kernel: FakeKernel) -> None:
    link = new_link(BusSpec("socketcan", "can7"), time.monotonic_ns)
    with pytest.raises(CanError, match=r"'socketcan:can7' cannot be opened: .*No such device"):
        link.open()


def test_the_account_of_the_kernel() -> None:
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    assert not is_held_back(ours)
    ours.send(bytes(16))
    assert is_held_back(ours)
    theirs.recv(16)
    assert not is_held_back(ours)
    ours.close()
    assert not is_held_back(ours)
    theirs.close()


@pytest.mark.parametrize(("carrier", "is_refused"), [("0\n", True), ("1\n", False), (None, False)])
def test_a_controller_off_the_bus_is_not_opened(
    tmp_path: Path, carrier: str | None, is_refused: bool
) -> None:
    (tmp_path / "can0").mkdir()
    if carrier is not None:
        (tmp_path / "can0" / "carrier").write_text(carrier)
    if is_refused:
        with pytest.raises(CanError, match="the controller is off the bus"):
            refuse_without_carrier("can0", tmp_path)
    else:
        refuse_without_carrier("can0", tmp_path)
