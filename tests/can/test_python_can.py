# SPDX-License-Identifier: Apache-2.0
"""The device over python-can, with a driver that does what a test wants."""

from __future__ import annotations

import logging
import time
from collections import deque

import can
import pytest
from can.interfaces import BACKENDS as INTERFACES

from safety_island.can import python_can
from safety_island.can.bus import BusEvent, EventKind
from safety_island.can.python_can import POLL_LIMIT, PythonCanDevice
from safety_island.can.python_can_bus import check_spec, entry_of, next_entry
from safety_island.can.spec import Backend, BusSpec
from safety_island.errors import ConfigurationError
from safety_island.platform.interfaces import CanError, CanFrame, CanResult
from tests.can.rig import triple

SPEC = BusSpec("vendor", "0")
FIRST = triple()[0]


class Driver(can.BusABC):
    """A driver whose received messages, state and failures a test sets."""

    def __init__(self) -> None:
        super().__init__(channel=0)
        self.received: deque[can.Message] = deque()
        self.sent: list[can.Message] = []
        self.controller = can.BusState.ACTIVE
        self.failure: Exception | None = None
        self.flushed = 0

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if self.failure:
            raise self.failure
        return (self.received.popleft() if self.received else None), True

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        if self.failure:
            raise self.failure
        self.sent.append(msg)

    def flush_tx_buffer(self) -> None:
        self.flushed += 1

    @property
    def state(self) -> can.BusState:
        return self.controller

    @state.setter
    def state(self, new_state: can.BusState) -> None:
        self.controller = new_state


@pytest.fixture
def driver(monkeypatch: pytest.MonkeyPatch) -> Driver:
    made = Driver()
    monkeypatch.setattr(python_can, "open_bus", lambda spec, **options: made)
    return made


def device(echoes: bool = False) -> PythonCanDevice:
    row = Backend("vendor", "", True, "vendor:0", "", echoes=echoes)
    made = PythonCanDevice(SPEC, row, time.monotonic_ns)
    made.open()
    return made


def message(frame: CanFrame, is_extended_id: bool = False) -> can.Message:
    return can.Message(
        arbitration_id=frame.arbitration_id, data=frame.data, is_extended_id=is_extended_id
    )


def test_frames_are_classic_and_standard(driver: Driver) -> None:
    assert device().send(FIRST, 0.01) is CanResult.SENT
    (sent,) = driver.sent
    assert (sent.arbitration_id, bytes(sent.data)) == FIRST
    assert not (sent.is_extended_id or sent.is_fd or sent.is_remote_frame or sent.is_error_frame)


@pytest.mark.parametrize(
    ("state", "events"),
    [
        (can.BusState.ACTIVE, []),
        (can.BusState.PASSIVE, [BusEvent(EventKind.ERROR_PASSIVE)]),
        (can.BusState.ERROR, [BusEvent(EventKind.BUS_OFF)]),
    ],
)
def test_the_state_of_the_controller(
    driver: Driver, state: can.BusState, events: list[BusEvent]
) -> None:
    driver.controller = state
    assert device().poll() == events


def test_one_poll_reads_no_more_than_its_limit(driver: Driver) -> None:
    driver.received.extend([message(CanFrame(0x555, b""))] * (POLL_LIMIT + 10))
    opened = device()
    assert opened.poll() == []
    assert len(driver.received) == 10
    opened.poll()
    assert not driver.received


def test_an_echo_is_not_foreign_but_a_second_one_is(driver: Driver) -> None:
    opened = device(echoes=True)
    opened.send(FIRST, 0.01)
    driver.received.extend([message(FIRST)] * 2)
    assert opened.poll() == [BusEvent(EventKind.FOREIGN_COMMAND, 0x100)]


def test_without_echoes_each_own_identifier_is_foreign(driver: Driver) -> None:
    opened = device()
    opened.send(FIRST, 0.01)
    driver.received.append(message(FIRST))
    assert opened.poll() == [BusEvent(EventKind.FOREIGN_COMMAND, 0x100)]


def test_an_extended_identifier_is_not_ours(driver: Driver) -> None:
    driver.received.append(message(FIRST, is_extended_id=True))
    assert device().poll() == []


def test_failures_are_values(driver: Driver) -> None:
    opened = device()
    driver.failure = can.CanOperationError("off", 100)
    assert opened.send(FIRST, 0.01) is CanResult.INTERFACE_DOWN
    assert opened.poll() == []


def test_a_closed_device_does_nothing(driver: Driver) -> None:
    opened = device()
    opened.discard()
    assert driver.flushed == 1
    opened.close()
    opened.close()
    opened.discard()
    assert driver.flushed == 1
    assert opened.poll() == ()
    assert opened.send(FIRST, 0.01) is CanResult.NOT_OPEN


def test_a_bus_that_cannot_be_read_is_an_error_of_one_line(driver: Driver) -> None:
    driver.received.append(message(FIRST))
    entry = next_entry(driver, SPEC, 0.0)
    assert entry is not None
    assert entry.frame == FIRST
    assert next_entry(driver, SPEC, 0.0) is None
    driver.failure = can.CanOperationError("gone\nfor good")
    with pytest.raises(CanError, match=r"^CAN bus 'vendor:0' cannot be read: gone for good$"):
        next_entry(driver, SPEC, 0.0)


def test_messages_as_entries() -> None:
    assert entry_of(can.Message(timestamp=1.0, is_error_frame=True)).is_error
    assert entry_of(message(FIRST, is_extended_id=True)).frame is None
    assert entry_of(message(FIRST)).frame == FIRST


def test_options_of_a_driver_whose_library_is_missing_are_told_when_it_is_opened(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(INTERFACES, "vendor", ("no.such.module", "Bus"))
    check_spec(BusSpec("vendor", "0", {"speed": 1}), "vendor:0")
    with pytest.raises(ConfigurationError, match="no option 'speed'"):
        check_spec(BusSpec("virtual", "0", {"speed": 1}), "virtual:0")


def test_the_log_of_python_can_stays_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    logging.getLogger("can.interface").error("what the island tells in its own words")
    assert capsys.readouterr().err == ""
