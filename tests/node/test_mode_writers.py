# SPDX-License-Identifier: Apache-2.0
"""The operation mode is sent on change: what one publisher said once must survive the other."""

from __future__ import annotations

import pytest

from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.input_gate.reason import SampleReason
from safety_island.life_cycle.reason import Reason
from safety_island.messages.inputs import OperationMode, encode_operation_mode
from safety_island.messages.wire import Time
from safety_island.node.memory import MemoryPublisher
from tests.node.rig import ROWS, Rig

ODOMETRY, MODE = 1, 4
"""Places in the table of inputs."""


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


def test_of_two_others_that_both_go_neither_is_heard(rig: Rig, first: MemoryPublisher) -> None:
    """The last word of a publisher that is gone, too, is nobody's mode."""
    others = [second(rig), second(rig)]
    for other in others:
        other.write(told(rig, Mode.STOP))
    rig.tick()
    for writer in (*others, first):
        writer.close()
    rig.tick()
    assert disengaged(rig) is Reason.MODE_WRITER_GONE
    assert rig.node.inputs.operation_mode is not None
    assert rig.node.inputs.operation_mode.mode == Mode.AUTONOMOUS


def test_of_two_others_the_one_that_lives_is_heard(rig: Rig, first: MemoryPublisher) -> None:
    """Whatever the other one said before it went, and whichever spoke last."""
    gone, lives = second(rig), second(rig)
    lives.write(told(rig, Mode.STOP))
    rig.tick()
    gone.write(told(rig, Mode.AUTONOMOUS))
    rig.tick()
    gone.close()
    first.close()
    rig.tick()
    assert disengaged(rig) is Reason.NOT_AUTONOMOUS


def test_a_flood_of_others_does_not_hide_the_owner(rig: Rig, first: MemoryPublisher) -> None:
    """They do not share its room, and cost the tick nothing."""
    flood = second(rig)
    first.write(told(rig, Mode.STOP))
    for _ in range(1500):
        flood.write(told(rig, Mode.AUTONOMOUS))
    report = rig.tick()
    item = rig.node.inputs.items[MODE]
    assert disengaged(rig) is Reason.NOT_AUTONOMOUS
    assert report.refused == item.refused[SampleReason.OTHER_PUBLISHER] == 1500
    assert item.subscription.received == 3
    assert item.superseded == 0


def test_a_publisher_that_comes_back_is_heard_again(rig: Rig, first: MemoryPublisher) -> None:
    """Its match was lost: it was gone and is there again, under the same identity."""
    writers = rig.domain._topics[topics.OPERATION_MODE.name].writers
    for alive in (frozenset[bytes](), writers):
        rig.domain._topics[topics.OPERATION_MODE.name].writers = alive
        rig.domain._changes += 1
        rig.tick()
    assert disengaged(rig) is Reason.NONE
    first.write(told(rig, Mode.STOP))
    rig.tick()
    assert disengaged(rig) is Reason.NOT_AUTONOMOUS


@pytest.mark.parametrize("per_tick", [1, 2, 4])
def test_a_history_that_is_delivered_again_leaves_the_newest(rig: Rig, per_tick: int) -> None:
    """Oldest first, over several ticks: after a match that was lost and renewed."""
    rig.everything(ROWS)
    rig.tick()
    history = []
    for mode in (Mode.AUTONOMOUS, Mode.STOP) * 4:
        history.append(told(rig, mode))
        rig.send(topics.OPERATION_MODE, history[-1])
        rig.tick()
    assert disengaged(rig) is Reason.NOT_AUTONOMOUS
    while history:
        for _ in range(per_tick):
            rig.send(topics.OPERATION_MODE, history.pop(0))
        rig.tick()
        assert disengaged(rig) is Reason.NOT_AUTONOMOUS
    assert set(rig.node.inputs.items[MODE].refused) == {SampleReason.DUPLICATE}


def test_a_mode_told_while_the_process_stood_still_is_heard(
    rig: Rig, first: MemoryPublisher
) -> None:
    """What else has waited is old; this is not told again."""
    first.write(told(rig, Mode.STOP))
    rig.odometry(1.0)
    before = rig.node.inputs.items[ODOMETRY].accepted
    rig.tick(after_s=5.0)
    assert disengaged(rig) is Reason.NOT_AUTONOMOUS
    assert rig.node.inputs.items[ODOMETRY].accepted == before


def test_discovery_forgets_no_stamp_of_an_owner_that_lives(rig: Rig) -> None:
    """An old odometry that is replayed as somebody joins stays refused."""
    captured = rig.listen(topics.ODOMETRY)
    rig.odometry(1.0, x=1.0)
    sample = captured.take_newest()
    rig.tick()
    for _ in range(3):
        rig.odometry(1.0, x=2.0)
        rig.tick()
    entry = topics.ODOMETRY
    rig.domain.publisher(entry.name, entry.type_name, entry.qos)
    item = rig.node.inputs.items[ODOMETRY]
    accepted = item.accepted
    rig.send(entry, sample.data)
    rig.tick()
    assert (item.accepted, item.refused[SampleReason.OLDER]) == (accepted, 1)
