# SPDX-License-Identifier: Apache-2.0
"""A second island, a second publisher: row 71 of the catalogue of faults and section E, live."""

from __future__ import annotations

import time

import pytest

from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.warning import InputWarning
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.live.driver import Driver
from tests.live.scene import ISLAND, Scene, refused, row

pytestmark = pytest.mark.live
NOTICED_S = 1.0
BUSY_S = 1.0
"""What a machine that is busy with other tests may add."""


def test_a_second_island_does_not_arm(scene: Scene, driver: Driver) -> None:
    driver.engage(scene)
    first = scene.state(State.ACTIVE).writer
    scene.start(ISLAND, at="second")
    second = scene.state(State.INIT, Reason.SECOND_ISLAND).writer
    assert second != first
    alarm = scene.status(lambda status: status.other_control_writers == 1, "an alarm", first)
    assert alarm.message.state == State.ACTIVE and alarm.message.published
    goes_on = scene.status(lambda status: status.tick > alarm.message.tick + 7, "more", first)
    assert goes_on.message.state == State.ACTIVE
    scene.kill(ISLAND)
    barred = scene.state(State.SILENT, Reason.RESTARTED_WHILE_MOVING, writer=second)
    assert barred.message.other_control_writers == 0
    statuses = scene.island.heard[topics.STATUS]
    assert not any(one.message.published for one in statuses if one.writer == second)
    driver.engage(scene)


def test_a_second_publisher_is_noticed_and_not_heard(scene: Scene, driver: Driver) -> None:
    driver.engage(scene)
    own = row(scene.state(State.ACTIVE).message, topics.ODOMETRY)
    assert (own.other_writers, own.warnings & InputWarning.SECOND_PUBLISHER) == (0, 0)
    other, began = Driver(scene.domains[1], Mode.STOP), time.monotonic()
    noticed = scene.status(
        lambda status: all(item.other_writers == 1 for item in status.inputs), "it is noticed"
    )
    assert noticed.at - began < NOTICED_S + BUSY_S
    scene.status(
        lambda status: all(i.warnings & InputWarning.SECOND_PUBLISHER for i in status.inputs),
        "it is warned of",
    )

    def both() -> None:
        driver.send()
        other.send()

    scene.meanwhile = both
    told = scene.status(
        lambda status: refused(status, topics.ODOMETRY, SampleReason.OTHER_PUBLISHER) > 10,
        "its samples are refused",
    ).message
    assert told.state == State.ACTIVE
    assert told.operation_mode == Mode.AUTONOMOUS
    assert row(told, topics.ODOMETRY).age < row(told, topics.ODOMETRY).age_limit
    scene.meanwhile = driver.send
    other.close()
    scene.status(lambda status: row(status, topics.ODOMETRY).other_writers == 0, "it is gone")


def test_the_second_publisher_takes_over_when_the_first_is_gone(
    scene: Scene, driver: Driver
) -> None:
    """The mode that it told once, while it was not heard, counts from then on."""
    driver.engage(scene)
    other = Driver(scene.domains[1], Mode.STOP)
    scene.status(
        lambda status: refused(status, topics.OPERATION_MODE, SampleReason.OTHER_PUBLISHER) == 1,
        "its mode is refused",
    )
    driver.close()
    scene.meanwhile = other.send
    ready = scene.state(State.READY, Reason.NOT_AUTONOMOUS).message
    assert ready.operation_mode == Mode.STOP
    other.engage(scene)
    other.close()
