# SPDX-License-Identifier: Apache-2.0
"""The lateral controller around the MPC: who is in control, failure, standstill."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.control.status import Mode, MpcStatus
from tests.control.lateral_rig import Rig, line, make_points, on_path


def off_path(steer: float = 0.1, **overrides: object) -> Rig:
    """A rig that steers back to a straight path, so that no two commands are alike."""
    rig = on_path(line(60.0), **overrides)
    rig.place(5.0, 0.3)
    rig.steer(steer)
    return rig


def test_two_points_alone_make_no_lateral_controller() -> None:
    """Nothing is commanded and nothing is remembered."""
    rig = on_path(make_points([0.0, 50.0]))
    before = rig.follower._lateral.tobytes(), rig.follower.command.tobytes()
    trace = rig.tick()
    assert rig.status is MpcStatus.NO_REFERENCE
    assert trace.mpc_status == MpcStatus.NO_REFERENCE and not trace.lateral_ready
    assert (rig.follower._lateral.tobytes(), rig.follower.command.tobytes()) == before
    assert not rig.follower.is_ready() and not rig.follower.step(rig.now)
    rig.path(line(50.0))
    assert rig.follower.is_ready() and rig.tick().lateral_ready


@pytest.mark.parametrize(
    ("mode", "enabled", "ours"),
    [
        (Mode.AUTONOMOUS, True, True),
        (Mode.AUTONOMOUS, False, False),
        (Mode.STOP, True, False),
        (Mode.LOCAL, True, False),
        (Mode.REMOTE, True, False),
        (Mode.UNKNOWN, True, False),
    ],
)
def test_under_control_is_enabled_and_autonomous(mode: Mode, enabled: bool, ours: bool) -> None:
    """Only then does the rate limit start from the last solution and the command get remembered."""
    rig = off_path()
    rig.mode(mode, enabled)
    trace = rig.tick()
    assert trace.under_control == ours
    assert trace.raw_steer_cmd_prev == (trace.u[0] if ours else np.float32(0.1))
    assert rig.lat.history_n == int(ours)
    assert rig.angle == np.float32(trace.u[0]), "the command comes out all the same"


def test_without_control_both_memories_of_the_solution_hold_the_clamped_sensor() -> None:
    rig = off_path(steer=1.2)
    rig.mode(Mode.LOCAL)
    trace = rig.tick()
    assert trace.raw_steer_cmd_prev == trace.raw_steer_cmd_pprev == np.float32(0.7)
    rig.mode()
    rig.tick()
    first = rig.trace.u[0]
    rig.tick()
    assert (trace.raw_steer_cmd_prev, trace.raw_steer_cmd_pprev) == (trace.u[0], first)


def test_the_low_pass_runs_on_while_somebody_else_drives() -> None:
    """Taking over carries on from the output that was not used."""
    kept, taken = (off_path(steering_lpf_cutoff_hz=1.0) for _ in range(2))
    taken.mode(Mode.LOCAL)
    for _ in range(4):
        kept.tick()
        taken.tick()
    taken.mode()
    for _ in range(3):
        kept.tick()
        taken.tick()
        assert kept.lat.steering_filter.tobytes() == taken.lat.steering_filter.tobytes()
        assert kept.angle == taken.angle


@pytest.mark.parametrize("solver", ["unconstraint_fast", "daqp", "osqp"])
def test_a_failure_holds_the_angle_with_no_rate(solver: str) -> None:
    rig = off_path(qp_solver_type=solver)
    rig.tick()
    held = rig.angle
    assert held != 0.0 and rig.rate != 0.0
    rig.place(5.0, 5.5)
    rig.steer(-0.9)
    for trace in rig.ticks(3):
        assert trace.mpc_status == MpcStatus.TOO_FAR
        assert (rig.angle, rig.rate) == (held, 0.0)
        assert not rig.follower.command["is_defined_steering_tire_rotation_rate"][0]
        assert not trace.is_steer_converged
        assert trace.raw_steer_cmd_prev == trace.raw_steer_cmd_pprev == np.float32(-0.7)
    rig.place(5.0, 0.3)
    rig.steer(0.1)
    trace = rig.tick()
    assert trace.mpc_status == MpcStatus.SOLVED
    assert rig.follower.command["is_defined_steering_tire_rotation_rate"][0]
    if solver != "unconstraint_fast":
        rate = math.radians(40.0) * rig.period  # a straight path: the first entry of the table
        assert abs(trace.u[0] - np.float32(-0.7)) <= rate + 1e-9, "from the clamped sensor"


def test_the_speed_and_acceleration_of_the_command_are_the_other_controllers() -> None:
    rig = off_path()
    rig.follower.command["velocity"] = 7.0
    rig.follower.command["acceleration"] = -1.5
    rig.tick()
    assert rig.follower.command["velocity"][0] == 7.0
    assert rig.follower.command["acceleration"][0] == -1.5


def test_a_first_command_that_fails_is_straight_ahead() -> None:
    """There is no last output yet."""
    rig = off_path()
    rig.place(5.0, 5.5)
    rig.tick()
    assert (rig.angle, rig.rate) == (0.0, 0.0)
