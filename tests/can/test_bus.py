# SPDX-License-Identifier: Apache-2.0
"""The delivery of one command to a device."""

from __future__ import annotations

from safety_island.can.bus import BusEvent, Delivery, EventKind, deliver
from safety_island.can.mock import MockBus
from safety_island.platform.interfaces import CanResult
from tests.can.rig import FakeClock, triple


def opened() -> MockBus:
    bus = MockBus()
    bus.open()
    return bus


def test_all_frames_before_the_deadline() -> None:
    bus, clock = opened(), FakeClock()
    assert deliver(bus, triple(), clock() + 1, clock) == Delivery(3, CanResult.SENT)


def test_no_frame_at_or_after_the_deadline() -> None:
    bus, clock = opened(), FakeClock()
    assert deliver(bus, triple(), clock(), clock) == Delivery(0, CanResult.TIMED_OUT)
    assert not bus.frames


def test_it_stops_at_the_first_frame_that_fails() -> None:
    bus, clock = opened(), FakeClock()
    bus.faults.extend([CanResult.SENT, CanResult.FAILED])
    assert deliver(bus, triple(), clock() + 1, clock) == Delivery(1, CanResult.FAILED)
    assert len(bus.frames) == 1


def test_it_asks_before_each_frame() -> None:
    bus, clock = opened(), FakeClock()
    found = deliver(bus, triple(), clock() + 1, clock, lambda index: index < 2)
    assert found == Delivery(2, CanResult.TIMED_OUT)


def test_a_bus_that_is_off_gets_no_frame() -> None:
    bus, clock = opened(), FakeClock()
    events = [BusEvent(EventKind.ERROR_WARNING), BusEvent(EventKind.BUS_OFF)]
    for event in events:
        bus.tell(event)
    assert deliver(bus, triple(), clock() + 1, clock) == Delivery(0, CanResult.BUS_OFF, events)
    assert not bus.frames
