# SPDX-License-Identifier: Apache-2.0
"""Requests to arm, and what the status answers."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safety_island.dds import topics
from safety_island.life_cycle.state import State
from safety_island.messages.arm import Arm, ArmResult, encode_arm
from safety_island.messages.wire import Time
from tests.node.rig import FakeFollower, Rig
from tests.node.test_life_cycle import can_only, tick

Ask = Callable[[int], None]


def asks(rig: Rig) -> Ask:
    """Return what sends a request."""
    publisher = rig.domain.publisher(topics.ARM.name, topics.ARM.type_name, topics.ARM.qos)

    def ask(nonce: int) -> None:
        publisher.write(encode_arm(Arm(Time(), nonce)))

    return ask


@pytest.fixture
def rig(follower: FakeFollower) -> Rig:
    return Rig(follower)


def result(rig: Rig) -> ArmResult:
    return rig.node.arming.result


def test_out_of_silence(rig: Rig) -> None:
    """Not while the cause stands; the same request twice is one."""
    ask = asks(rig)
    assert tick(rig).life.state is State.SILENT  # it moves, and nobody has left autonomous mode
    ask(1)
    assert tick(rig, stale=True).life.state is State.ACTIVE
    assert result(rig) is ArmResult.ARMED
    for _ in range(4):
        tick(rig, stale=True)
    assert rig.node.life_cycle.state is State.SILENT
    ask(1)
    assert tick(rig).life.state is State.SILENT
    ask(2)
    assert tick(rig, stale=True).life.state is State.ACTIVE
    for _ in range(4):
        tick(rig, stale=True)
    ask(3)
    assert tick(rig, stale=True).life.state is State.SILENT
    assert result(rig) is ArmResult.REFUSED


@pytest.mark.parametrize("is_first", [True, False])
def test_where_nothing_keeps_it_from_sending(rig: Rig, is_first: bool) -> None:
    """Also in the tick in which the inputs are complete."""
    ask = asks(rig)
    if not is_first:
        tick(rig, engaged=False)
    ask(1)
    assert tick(rig, engaged=False).life.state is State.READY
    assert result(rig) is ArmResult.NOT_NEEDED


def test_without_inputs(rig: Rig) -> None:
    asks(rig)(1)
    assert rig.tick().life.state is State.INIT
    assert result(rig) is ArmResult.REFUSED


def test_a_stop_goes_on(follower: FakeFollower) -> None:
    rig, _ = can_only(follower)
    for _ in range(5):
        tick(rig, stale=True)
    asks(rig)(1)
    assert tick(rig).life.state is State.STOP
    assert result(rig) is ArmResult.REFUSED
