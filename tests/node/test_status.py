# SPDX-License-Identifier: Apache-2.0
"""Each field of the status says what the node knows: no two of them share a value."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safety_island.command.status_message import SNAPSHOT_LAYOUT
from safety_island.control.status import ControllerLimit, LongitudinalState, Mode, MpcStatus
from safety_island.dds import topics
from safety_island.guard import Verdict
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.warning import InputWarning
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.inputs import Steering
from safety_island.messages.status import NO_VALUE, decode_status
from safety_island.messages.status_fields import InputStatus, Status
from safety_island.messages.wire import Time
from safety_island.node.input_status import input_values
from safety_island.node.inputs import INPUTS
from safety_island.params import parameters_hash
from safety_island.platform import Tick
from tests.node.rig import ROWS, FakeFollower, Rig
from tests.node.test_life_cycle import tick

ODOMETRY = 1


@pytest.fixture
def heard(rig: Rig) -> Any:
    """Returns the status of the last tick."""
    reader = rig.listen(topics.STATUS)

    def newest() -> Status:
        return decode_status(reader.take_newest().data)

    return newest


def test_a_tick_that_drives(rig: Rig, follower: FakeFollower, heard: Any) -> None:
    trace = follower.trace
    for number, name in enumerate(("lateral_error", "yaw_error", "residual", "stop_dist")):
        trace[name] = 0.5 + number
    trace["target_vel"], trace["angle_limited"], trace["jerk_limited"] = 4.5, True, True
    trace["solver_status"], trace["solver_iterations"], trace["active_constraints"] = 11, 12, 13
    trace["lon_state"], trace["mpc_status"] = LongitudinalState.DRIVE, MpcStatus.SOLVED
    follower.command["steering_tire_rotation_rate"], follower.command["velocity"] = 0.25, 1.5
    rig.node.status.memory_bytes = 123456
    tick(rig, engaged=False)
    tick(rig)
    rig.node.sender.outputs[0].failed = 6
    assert tick(rig).life.state is State.ACTIVE
    status = heard()
    assert status.stamp == rig.stamp
    assert (status.tick, status.commands, status.memory, status.sequence) == (3, 3, 123456, 3)
    errors = (status.lateral_error, status.yaw_error, status.residual, status.stop_dist)
    assert (*errors, status.target_vel) == (0.5, 1.5, 2.5, 3.5, 4.5)
    command = (status.command_angle, status.command_rate, status.command_velocity)
    assert (*command, status.command_acceleration) == (0.125, 0.25, 1.5, -1.5)
    assert status.controller_limits == ControllerLimit.STEERING_ANGLE | ControllerLimit.JERK
    solver = (status.solver_status, status.solver_iterations, status.active_constraints)
    assert solver == (11, 12, 13)
    assert (status.state, status.reason, status.subject) == (State.ACTIVE, Reason.NONE, NO_VALUE)
    assert (status.latched_cause, status.operation_mode) == (Reason.NONE, Mode.AUTONOMOUS)
    controllers = (status.longitudinal_state, status.mpc_status)
    assert controllers == (LongitudinalState.DRIVE, MpcStatus.SOLVED)
    assert (status.output_failures, status.output_mode, status.arm_result) == (6, 0, 0)
    flags = (status.armed, status.engaged, status.control_enabled, status.published)
    assert all(flags) and not status.degraded and not status.other_control_writers
    assert (status.guard_refused, status.missed_periods, status.overruns) == (0, 0, 0)


def test_what_the_guard_did(rig: Rig, follower: FakeFollower, heard: Any) -> None:
    tick(rig, engaged=False)
    follower.command["acceleration"] = 50.0
    tick(rig, engaged=False)
    status = heard()
    assert (status.guard_verdict, status.guard_clamped) == (Verdict.CLAMPED, 1)
    assert status.guard_limits == rig.node.check.limits != 0
    assert status.command_acceleration < 50.0
    follower.command["acceleration"] = math.nan
    tick(rig, engaged=False)
    status = heard()
    assert (status.guard_verdict, status.guard_refused) == (Verdict.REFUSED, 1)
    assert math.isnan(status.command_acceleration) and not status.published


def test_in_a_tick_without_a_command_the_guard_was_not_asked(
    rig: Rig, follower: FakeFollower, heard: Any
) -> None:
    rig.tick(0.15)
    status = heard()
    assert (status.guard_verdict, status.guard_limits) == (NO_VALUE, 0)
    tick(rig, engaged=False)
    follower.command["acceleration"] = 50.0
    tick(rig, engaged=False)
    assert heard().guard_verdict == Verdict.CLAMPED
    for _ in range(4):
        rig.tick(0.15)
    status = heard()
    assert (status.guard_verdict, status.guard_limits) == (NO_VALUE, 0)
    assert status.guard_clamped > 0


def test_an_input_that_is_refused_and_one_that_is_old(rig: Rig, heard: Any) -> None:
    tick(rig, engaged=False)
    rig.send(topics.ODOMETRY, b"\0\1\0\0")
    rig.tick(0.15)
    status = heard()
    found = status.inputs[ODOMETRY]
    assert (found.accepted, found.received, found.refused_in_a_row) == (1, 2, 1)
    assert found.last_refusal == SampleReason.TRUNCATED
    assert found.refused[SampleReason.TRUNCATED] == sum(found.refused) == 1
    assert found.age == pytest.approx(0.3) and found.age_limit == 0.5
    assert found.writer_guid == rig.node.inputs.items[ODOMETRY].writer_guid != bytes(16)
    rig.tick(0.15)
    rig.tick(0.15)
    status = heard()
    assert (status.state, status.reason) == (State.INIT, Reason.INPUT_STALE)
    assert INPUTS[status.subject].name == "odometry"
    assert status.inputs[ODOMETRY].warnings & InputWarning.AGE
    assert not status.armed and not status.published and not status.controller_limits
    assert status.inputs[ODOMETRY].accepted == 1 and status.commands == 3


def test_late_ticks(rig: Rig, heard: Any) -> None:
    for number in range(1, 4):
        rig.everything(ROWS)
        rig.clock.advance_to_ns(rig.clock.monotonic_ns() + 150_000_000)
        rig.node.tick(due=Tick(0, 2_000_000, 1))
        status = heard()
        assert (status.missed_periods, status.missed_periods_total) == (1, number)
        assert (status.overruns, status.lateness) == (number, pytest.approx(0.002))
    assert status.degraded


def test_before_anything_came_nothing_is_made_up(rig: Rig, heard: Any) -> None:
    rig.tick()
    status = heard()
    numbers = (status.lateral_error, status.target_vel, status.command_angle)
    assert all(map(math.isnan, numbers))
    assert (status.longitudinal_state, status.mpc_status) == (NO_VALUE, NO_VALUE)
    assert status.reason == Reason.WAITING_FOR_INPUT and status.subject == 0
    for item in status.inputs:
        assert (item.accepted, item.last_refusal, item.writer_guid) == (0, NO_VALUE, bytes(16))
        assert item.age == math.inf


def test_the_inputs_are_told_in_the_order_of_the_message(rig: Rig) -> None:
    item = rig.node.inputs.items[ODOMETRY]
    item.refusals[4], item.writer_guid = 1, bytes(range(16))
    item.message, item.source_ns = Steering(Time(8, 9), 0.0), 10
    item.accepted, item.subscription.received, item.superseded, item.refused_in_a_row = 2, 3, 4, 5
    item.stamps.state["delay_s"] = 0.25  # type: ignore[union-attr]
    item.warnings, item.last_refusal = 6, 7
    item.writers.update(frozenset({b"a" * 16}), 0.0)
    item.writers.update(frozenset({b"a" * 16, b"b" * 16}), 1.0)
    counts = (0, 1, *(0,) * 30)
    times, numbers = (8_000_000_009, 10), (2, 3, 4, 5)
    expected = InputStatus(
        counts, item.writer_guid, *times, *numbers, 0.125, item.age_limit_s, 0.25, 6, 7, 1
    )
    refusals, *rest = input_values([item], [0.125])
    found = InputStatus(tuple(np.frombuffer(refusals, "<u4").tolist()), *rest)
    assert found == expected
    assert input_values([item, item], [0.125, 0.125])[len(found) :] == [refusals, *rest]


def test_what_an_exact_replay_needs(rig: Rig, heard: Any) -> None:
    rig.tick(0.15)
    status = heard()
    assert {(item.sample_stamp, item.source_time) for item in status.inputs} == {(0, 0)}
    rig.clock.set_wall_offset_ns(7_000_000_000)
    rig.everything(ROWS)
    sent = rig.clock.wall_ns()
    rig.tick(0.15)
    rig.tick(0.15)
    status = heard()
    assert status.now == rig.clock.monotonic_ns() == sent + 300_000_000 - 7_000_000_000
    assert {(item.sample_stamp, item.source_time) for item in status.inputs} == {(sent, sent)}
    rig.clock.advance_to_ns(rig.clock.monotonic_ns() + 150_000_000)
    rig.send(topics.ODOMETRY, b"\0\1\0\0")
    rig.node.tick()
    assert heard().inputs[ODOMETRY].source_time == sent  # of what is in force
    assert status.parameters_hash == parameters_hash(rig.node.parameters)
    assert status.snapshot_layout == SNAPSHOT_LAYOUT
