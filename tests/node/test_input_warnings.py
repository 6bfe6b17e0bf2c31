# SPDX-License-Identifier: Apache-2.0
"""When the warnings of the inputs are looked for, and that none is missed in between."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safety_island.dds import topics
from safety_island.input_gate.warning import InputWarning
from safety_island.messages.inputs import Steering, encode_steering
from safety_island.messages.wire import Time
from safety_island.node.input_set import STEERING
from safety_island.node.input_warnings import WATCH_EVERY_S
from tests.node.rig import ROWS, FakeFollower, Rig

PERIOD_S = 0.15
RATE = InputWarning.RATE


@pytest.fixture
def rig() -> Rig:
    """A drive of some seconds, in which nothing is wrong."""
    rig = Rig(FakeFollower())
    drive(rig, 20)
    assert bits(rig) == 0
    return rig


def drive(rig: Rig, ticks: int) -> None:
    for _ in range(ticks):
        rig.everything(ROWS)
        rig.tick()


def bits(rig: Rig) -> int:
    """The warnings about the steering."""
    return rig.node.inputs.warnings[STEERING]


@pytest.fixture
def looks(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The inputs that are looked at from now on, one after the other."""
    found: list[int] = []
    watch = rig.node.inputs._watch
    look: Callable[..., int] = watch._look

    def noted(index: int, now: float, age_s: float) -> int:
        found.append(index)
        return look(index, now, age_s)

    monkeypatch.setattr(watch, "_look", noted)
    return found


def test_while_nothing_is_wrong_they_are_looked_for_now_and_then(
    rig: Rig, looks: list[int]
) -> None:
    ticks = 40
    drive(rig, ticks)
    times = len(looks) / 5
    assert 0 < times <= ticks * PERIOD_S / WATCH_EVERY_S + 1


def test_a_rate_that_is_too_low_needs_no_look_in_every_tick(rig: Rig, looks: list[int]) -> None:
    rig.node.inputs.items[STEERING].rate.too_low = True
    drive(rig, 5)
    assert bits(rig) == RATE
    looks.clear()
    drive(rig, 40)
    assert bits(rig) == RATE
    assert len(looks) / 5 <= 40 * PERIOD_S / WATCH_EVERY_S + 1


def test_it_ends_with_the_next_look(rig: Rig) -> None:
    rate = rig.node.inputs.items[STEERING].rate
    rate.too_low = True
    drive(rig, 5)
    rate.too_low = False
    drive(rig, 1 + round(WATCH_EVERY_S / PERIOD_S))
    assert bits(rig) == 0


def without_steering(rig: Rig) -> None:
    for send in (rig.odometry, rig.acceleration, rig.mode):
        send()
    rig.trajectory(ROWS)
    rig.tick()


def test_an_age_is_told_in_its_tick_and_ends_in_its_tick(rig: Rig) -> None:
    """Also while a rate is too low, which alone needs no look."""
    rig.node.inputs.items[STEERING].rate.too_low = True
    drive(rig, 5)
    without_steering(rig)
    assert bits(rig) == InputWarning.AGE | RATE
    drive(rig, 1)
    assert bits(rig) == RATE


def test_a_delay_is_told_in_its_tick_and_ends_in_its_tick(rig: Rig) -> None:
    drive(rig, 1)
    for _ in range(2):
        without_steering(rig)
    told = Time.from_nanoseconds(rig.stamp.nanoseconds - 350_000_000)
    rig.send(topics.STEERING, encode_steering(Steering(told, 0.0)))
    without_steering(rig)
    assert bits(rig) & InputWarning.DELAY
    drive(rig, 1)
    assert not bits(rig) & InputWarning.DELAY
