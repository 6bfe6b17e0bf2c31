# SPDX-License-Identifier: Apache-2.0
"""Odometry that is no number, for a second: row 20 of the catalogue of faults, live."""

from __future__ import annotations

import math

import pytest

from safety_island.dds import topics
from safety_island.input_gate.reason import SampleReason
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.live.driver import Driver
from tests.live.scene import Scene, refused, row

pytestmark = pytest.mark.live
SAMPLES = 30
"""About a second of them, however busy the machine is."""


def test_odometry_that_is_no_number(scene: Scene, driver: Driver) -> None:
    driver.engage(scene)
    scene.status(lambda status: status.commands > 10, "commands come")
    before = scene.status(lambda status: status.published, "a command").message
    driver.speed = math.nan
    scene.state(State.SILENT, Reason.INPUT_STALE)
    bad = scene.status(
        lambda status: refused(status, topics.ODOMETRY, SampleReason.NOT_FINITE) >= SAMPLES,
        "samples are refused",
    ).message
    assert bad.state == State.SILENT
    assert row(bad, topics.ODOMETRY).last_refusal == SampleReason.NOT_FINITE
    assert row(bad, topics.ODOMETRY).age > row(bad, topics.ODOMETRY).age_limit
    driver.speed = 1.0
    scene.state(State.SILENT, Reason.LATCHED)
    driver.engage(scene)
    after = scene.status(lambda status: status.published, "a command").message
    assert row(after, topics.ODOMETRY).refused_in_a_row == 0
    assert after.command_angle == pytest.approx(before.command_angle, abs=0.01)
    assert after.command_velocity == pytest.approx(before.command_velocity, abs=0.1)
    _assert_all_commands_are_finite(scene)


def _assert_all_commands_are_finite(scene: Scene) -> None:
    commands = [heard.message for heard in scene.island.heard[topics.CONTROL]]
    assert commands
    for command in commands:
        values = (
            command.steering_tire_angle, command.steering_tire_rotation_rate, command.velocity,
            command.acceleration,
        )  # fmt: skip
        assert all(map(math.isfinite, values))
