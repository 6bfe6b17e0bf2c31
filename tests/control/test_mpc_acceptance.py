# SPDX-License-Identifier: Apache-2.0
"""What Autoware's own tests of the MPC check: straight on, right turn, delay buffer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from safety_island.control.status import MpcStatus
from safety_island.kernel.records import Records
from tests.control.lateral_rig import Rig, make_points, on_path
from tests.control.vehicles import MODELS

SUITE: dict[str, Any] = {
    "wheel_base": 2.7,
    "vehicle_model_steer_tau": 0.1,
    "ctrl_period": 0.03,
    "max_steer_angle": 0.610865,
    "steer_rate_lim_dps_list_by_curvature": (150.0, 150.0, 150.0),  # 2.61799 rad/s
    "steer_rate_lim_dps_list_by_velocity": (150.0, 150.0, 150.0),
    "path_filter_moving_ave_num": 35,
    "curvature_smoothing_num_traj": 1,
    "curvature_smoothing_num_ref_steer": 35,
    "enable_path_smoothing": True,
    "extend_trajectory_for_end_yaw_control": True,
}


SOLVERS = ("unconstraint_fast", "osqp", "daqp")


STRAIGHT = make_points([0.0, 1.0, 2.0, 3.0, 4.0])


RIGHT_TURN = make_points([-1.0, 0.0, 1.0, 2.0], [-1.0, 0.0, -1.0, -2.0])


def suite_rig(points: Records, model: str, solver: str, **overrides: Any) -> Rig:
    return on_path(points, **(SUITE | MODELS[model] | {"qp_solver_type": solver} | overrides))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("model", MODELS)
def test_a_straight_path_wants_no_steering(model: str, solver: str) -> None:
    rig = suite_rig(STRAIGHT, model, solver)
    trace = rig.tick()
    assert rig.status is MpcStatus.SOLVED
    assert (rig.angle, rig.rate) == (0.0, 0.0)
    np.testing.assert_allclose(trace.u[:50], 0.0, rtol=0, atol=1e-12)
    assert rig.follower.command["is_defined_steering_tire_rotation_rate"][0]


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("model", MODELS)
def test_a_right_turn_wants_steering_to_the_right(model: str, solver: str) -> None:
    rig = suite_rig(RIGHT_TURN, model, solver)
    trace = rig.tick()
    assert rig.status is MpcStatus.SOLVED
    assert rig.angle < 0.0 and rig.rate < 0.0 and trace.u[0] < 0.0


def test_commands_wait_in_the_delay_buffer() -> None:
    """Three periods of delay: three zeros, and as many after four solves."""
    rig = suite_rig(STRAIGHT, "kinematics", "unconstraint_fast", input_delay=0.09)
    for trace in rig.ticks(4):
        assert rig.status is MpcStatus.SOLVED
        assert (rig.angle, rig.rate, trace.u[0]) == (0.0, 0.0, 0.0)
        assert rig.lat.delay_n == 3
        assert list(rig.lat.delay[:3]) == [0.0, 0.0, 0.0]
