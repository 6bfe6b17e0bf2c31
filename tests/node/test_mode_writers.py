"""The operation mode is sent on change: what one publisher said once must survive the other."""

from __future__ import annotations

import pytest

from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.gate.reason import SampleReason
from safety_island.life_cycle.reason import Reason
from safety_island.messages.inputs import OperationMode, encode_operation_mode
from safety_island.messages.wire import Time
from safety_island.node.memory import MemoryPublisher
from tests.node.rig import ROWS, Rig

MODE = 4
"""Place in the table of inputs."""


@pytest.fixture
def first(rig: Rig) -> MemoryPublisher:
    """The publisher of the mode that the island keeps to; it says AUTONOMOUS."""
    rig.everything(ROWS)
    assert rig.tick().published
    rig.mode(Mode.AUTONOMOUS, enabled=True)
    rig.tick()
    assert disengaged(rig) is Reason.NONE
    return rig._publishers[topics.OPERATION_MODE]


def disengaged(rig: Rig) -> Reason:
    return rig.node.inputs.disengaged


def second(rig: Rig) -> MemoryPublisher:
    entry = topics.OPERATION_MODE
    return rig.domain.publisher(entry.name, entry.type_name, entry.qos)


def told(rig: Rig, mode: Mode, stamp: Time | None = None) -> bytes:
    return encode_operation_mode(OperationMode(stamp or rig.stamp, mode, mode is Mode.AUTONOMOUS))


def test_what_a_second_publisher_said_counts_when_the_first_is_gone(
    rig: Rig, first: MemoryPublisher
) -> None:
    second(rig).write(told(rig, Mode.STOP))
    assert rig.tick().refused == 1
    item = rig.node.inputs.items[MODE]
    assert item.refused == {SampleReason.OTHER_PUBLISHER: 1}
    assert disengaged(rig) is Reason.NONE
    first.close()
    rig.tick()
    assert disengaged(rig) is Reason.NOT_AUTONOMOUS
    assert item.accepted_at == rig.clock.monotonic_ns() / 1e9


def test_a_second_publisher_that_went_first_is_not_heard(rig: Rig, first: MemoryPublisher) -> None:
    other = second(rig)
    other.write(told(rig, Mode.STOP))
    rig.tick()
    other.close()
    first.close()
    rig.tick()
    assert disengaged(rig) is Reason.MODE_WRITER_GONE


def test_the_next_publisher_may_have_another_clock(rig: Rig, first: MemoryPublisher) -> None:
    second(rig).write(told(rig, Mode.STOP, Time(1, 0)))
    first.close()
    rig.tick()
    assert disengaged(rig) is Reason.NOT_AUTONOMOUS
