# SPDX-License-Identifier: Apache-2.0
"""The island dies while it drives, or is asked to arm: row 52 of the catalogue of faults, live."""

from __future__ import annotations

import time

import pytest

from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.arm import ArmResult
from safety_island.node.inputs import INPUTS
from tests.live.driver import Driver
from tests.live.ear import sent_since
from tests.live.scene import ISLAND, Scene

pytestmark = pytest.mark.live


def test_a_restarted_island_does_not_arm_itself(scene: Scene, driver: Driver) -> None:
    """The mode says AUTONOMOUS throughout, and the vehicle moves."""
    first = scene.state(State.SILENT, Reason.RESTARTED_WHILE_MOVING)
    driver.engage(scene)
    scene.kill(ISLAND)
    restarted_ns = time.time_ns()
    scene.start(ISLAND)
    again = scene.state(State.SILENT, Reason.RESTARTED_WHILE_MOVING)
    assert again.writer != first.writer
    assert again.message.commands == 0
    assert not sent_since(scene.island.heard[topics.CONTROL], restarted_ns)
    driver.engage(scene)


def test_the_vehicle_goes_on_after_its_island_was_started_again(drive: Scene) -> None:
    drive.kill(ISLAND)
    modes = drive.main.heard[topics.OPERATION_MODE]
    drive.until(lambda: modes[-1].message.mode == Mode.STOP, "autonomous mode is left")
    restarted_ns = time.time_ns()
    drive.start(ISLAND)
    drive.state(State.READY, Reason.NOT_AUTONOMOUS)
    drive.state(State.ACTIVE)
    drive.moves()
    stamps_ns = sent_since(drive.main.heard[topics.CONTROL], restarted_ns)
    assert min(stamps_ns) > restarted_ns


def test_arming_by_hand_when_the_cause_is_gone_and_not_before(scene: Scene, driver: Driver) -> None:
    driver.engage(scene)
    driver.absent = {topics.STEERING}
    stale = scene.state(State.SILENT, Reason.INPUT_STALE)
    assert INPUTS[stale.message.subject].topic is topics.STEERING
    code, said = scene.arm()
    assert (code, said.partition(":")[0]) == (1, "refused")
    driver.absent = set()
    latched = scene.state(State.SILENT, Reason.LATCHED).message
    assert latched.arm_result == ArmResult.REFUSED
    assert latched.latched_cause == Reason.INPUT_STALE
    code, said = scene.arm()
    assert (code, said.partition(":")[0]) == (0, "armed")
    armed = scene.state(State.ACTIVE).message
    assert armed.arm_result == ArmResult.ARMED and armed.published
