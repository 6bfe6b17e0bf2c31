# SPDX-License-Identifier: Apache-2.0
"""The thread that is kept waiting instead of the control loop."""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest

from safety_island.can import thread_link
from safety_island.can.bus import BusEvent, Delivery, EventKind
from safety_island.can.command import Cause
from safety_island.can.output import CanOutput
from safety_island.can.thread_link import ThreadLink
from safety_island.command.mode import OutputMode
from safety_island.platform.interfaces import CanError, CanResult
from tests.can.blocking_bus import BlockingBus
from tests.can.rig import REFERENCE, LogLines, triple, until

BUDGET_S = 0.02
PATIENCE_S = 5.0


@pytest.fixture
def bus() -> BlockingBus:
    return BlockingBus()


@pytest.fixture
def link(bus: BlockingBus) -> Iterator[ThreadLink]:
    made = ThreadLink(bus, time.monotonic_ns)
    made.open()
    yield made
    bus.gate.set()
    made.close()


def stick(link: ThreadLink, bus: BlockingBus) -> None:
    """Send until the thread is stuck in the device."""
    bus.gate.clear()
    assert until(
        lambda: (
            link.send(triple(1), BUDGET_S).result is CanResult.TIMED_OUT and bus.is_waiting.is_set()
        )
    )


def test_a_command_goes_through(link: ThreadLink, bus: BlockingBus) -> None:
    assert link.send(triple(), PATIENCE_S) == Delivery(3, CanResult.SENT)
    assert tuple(bus.frames) == triple()


def test_a_failed_frame_is_told(link: ThreadLink, bus: BlockingBus) -> None:
    bus.faults.extend([CanResult.SENT, CanResult.QUEUE_FULL])
    assert link.send(triple(), PATIENCE_S) == Delivery(1, CanResult.QUEUE_FULL)


def test_a_bus_that_blocks_costs_the_budget_once(link: ThreadLink, bus: BlockingBus) -> None:
    """Row 56: the first command waits for its budget, each further one not at all."""
    stick(link, bus)
    begun = time.monotonic()
    for sequence in range(2, 100):
        assert link.send(triple(sequence), PATIENCE_S) == Delivery(0, CanResult.TIMED_OUT)
    assert time.monotonic() - begun < PATIENCE_S


def test_of_an_abandoned_command_no_further_frame_leaves(
    link: ThreadLink, bus: BlockingBus
) -> None:
    stick(link, bus)
    bus.gate.set()
    assert until(lambda: link.send(triple(2), PATIENCE_S).result is CanResult.SENT)
    assert [frame.arbitration_id for frame in bus.frames] == [0x100, 0x100, 0x101, 0x102]
    assert list(bus.frames)[1:] == list(triple(2))


def test_it_opens_again_without_making_the_loop_wait(link: ThreadLink, bus: BlockingBus) -> None:
    bus.gate.clear()
    link.reopen()
    assert link.is_opening
    assert link.send(triple(), PATIENCE_S) == Delivery(0, CanResult.NOT_OPEN)
    bus.gate.set()
    assert until(lambda: not link.is_opening)
    assert link.send(triple(), PATIENCE_S).result is CanResult.SENT
    assert bus.opened == 2


def test_an_opening_that_fails_leaves_it_closed(link: ThreadLink, bus: BlockingBus) -> None:
    bus.refusals = 1
    link.reopen()
    assert until(lambda: not link.is_opening)
    assert link.send(triple(), PATIENCE_S) == Delivery(0, CanResult.NOT_OPEN)


def test_what_waits_is_thrown_away_before_the_next_command(
    link: ThreadLink, bus: BlockingBus
) -> None:
    link.discard()
    assert link.send(triple(), PATIENCE_S).result is CanResult.SENT
    assert bus.discarded == 1


def test_an_error_at_the_start_is_raised(bus: BlockingBus) -> None:
    bus.refusals = 1
    link = ThreadLink(bus, time.monotonic_ns)
    with pytest.raises(CanError, match="told to refuse"):
        link.open()
    assert link.send(triple(), PATIENCE_S).result is CanResult.NOT_OPEN
    link.close()
    assert bus.closed.is_set()


def test_an_opening_that_takes_too_long_is_an_error(
    bus: BlockingBus, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(thread_link, "OPEN_LIMIT_S", 0.01)
    bus.gate.clear()
    link = ThreadLink(bus, time.monotonic_ns)
    with pytest.raises(CanError, match="did not open within"):
        link.open()
    bus.gate.set()
    link.close()


def test_closing_a_bus_that_blocks_does_not_wait_for_it(bus: BlockingBus) -> None:
    link = ThreadLink(bus, time.monotonic_ns)
    link.open()
    stick(link, bus)
    link.close()
    assert not bus.closed.is_set()
    bus.gate.set()
    assert bus.closed.wait(PATIENCE_S)


def test_closing_before_opening_does_nothing(bus: BlockingBus) -> None:
    ThreadLink(bus, time.monotonic_ns).close()
    assert bus.opened == 0


def test_output_recovers_from_a_bus_that_blocked(link: ThreadLink, bus: BlockingBus) -> None:
    log = LogLines()
    output = CanOutput(OutputMode.CAN_ONLY, link, PATIENCE_S / 10, time.monotonic_ns, log)
    bus.gate.clear()
    assert output.send(REFERENCE, 0) is False
    assert output.send(REFERENCE, 0) is False
    bus.gate.set()
    assert until(lambda: output.send(REFERENCE, 0))
    # The frame that the bus was blocked in belongs to no complete triple; the rest are triples.
    assert [frame.arbitration_id for frame in bus.frames][1:] == [0x100, 0x101, 0x102]
    assert output.counters.reopened >= 1
    assert output.counters.frames[0x100, Cause.TIMED_OUT] >= 2
    assert len([line for line in log.lines if "within a tenth" in line]) == 1


def test_events_come_without_a_command(link: ThreadLink, bus: BlockingBus) -> None:
    bus.tell(BusEvent(EventKind.FOREIGN_COMMAND, 0x100))
    assert link.poll() == ()  # the thread is asked
    assert until(lambda: link.poll() == [BusEvent(EventKind.FOREIGN_COMMAND, 0x100)])


def test_a_device_that_blocks_does_not_make_polls_pile_up(
    link: ThreadLink, bus: BlockingBus
) -> None:
    stick(link, bus)
    for _ in range(100):
        assert link.poll() == ()
    assert link._tasks.qsize() <= 1


def test_a_device_that_is_closed_is_not_polled(bus: BlockingBus) -> None:
    link = ThreadLink(bus, time.monotonic_ns)
    assert link.poll() == ()
    assert link._tasks.qsize() == 0
