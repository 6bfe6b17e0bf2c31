# SPDX-License-Identifier: Apache-2.0
"""Whatever comes in within its bounds, what goes out and what is remembered are numbers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.input_check import (
    MAX_ACCELERATION,
    MAX_POSITION,
    MAX_SPEED,
    MAX_TURN,
)
from safety_island.control.records import POINT
from safety_island.control.status import Refusal
from safety_island.kernel.records import Records
from tests.control.follower_rig import finite
from tests.control.lateral_rig import START
from tests.control.vehicles import DYNAMICS
from tests.golden.harness import firmware

EVERYTHING: dict[str, Any] = {
    "input_delay": 0.24,
    "use_steer_prediction": True,
    "enable_path_smoothing": True,
    "extend_trajectory_for_end_yaw_control": True,
    "steering_offset_enable_auto_steering_offset_removal": True,
    "steering_offset_update_vel_threshold": 0.0,
    "steering_lpf_cutoff_hz": 3.0,
    "error_deriv_lpf_cutoff_hz": 3.0,
    "ego_nearest_dist_threshold": 3.0,
    "ego_nearest_yaw_threshold": 1.046,
    "enable_brake_keeping_before_stop": True,
    "acc_feedback_gain": 0.1,
    "slope_source": "trajectory_adaptive",
    "admissible_position_error": 100.0,
    "admissible_yaw_error_rad": math.pi,
}
SETS: dict[str, dict[str, Any]] = {
    "firmware": {},
    "daqp": {"qp_solver_type": "daqp"},
    "everything": EVERYTHING | {"qp_solver_type": "daqp"},
    "no delay": EVERYTHING | {"vehicle_model_type": "kinematics_no_delay"},
    "dynamics": EVERYTHING | {"vehicle_model_type": "dynamics"} | DYNAMICS,
}

SIZES = st.sampled_from([1e-300, 1e-6, 0.3, 30.0, 2e3, MAX_POSITION])
"""How far apart things are [m]."""


def within(bound: float) -> st.SearchStrategy[float]:
    """A number within a bound, often at it, at zero, or tiny."""
    special = st.sampled_from([0.0, -0.0, bound, -bound, 5e-324, -5e-324, 1e-9, bound * 1e-3])
    return special | st.floats(-bound, bound)


@st.composite
def turns(draw: st.DrawFn) -> tuple[float, float, float, float]:
    """A quaternion, its norm up to a hundredth off."""
    parts = np.array([draw(st.floats(-1.0, 1.0)) for _ in range(4)])
    norm = float(np.linalg.norm(parts))
    if norm < 1e-3:
        return 0.0, 0.0, 0.0, 1.0
    x, y, z, w = (float(part) for part in parts / norm * draw(st.floats(0.9905, 1.0095)))
    return x, y, z, w


@st.composite
def trajectories(draw: st.DrawFn) -> Records:
    """A few points, anywhere from a heap to all over the map, or along a line."""
    n = draw(st.integers(2, 8))
    size = draw(SIZES)
    points = np.zeros(n, POINT)
    for point in points:
        for name in ("x", "y", "z"):
            point[name] = draw(within(size))
        point["qx"], point["qy"], point["qz"], point["qw"] = draw(turns())
        for name, bound in (("v", MAX_SPEED), ("v_lat", MAX_SPEED), ("acc", MAX_ACCELERATION)):
            point[name] = np.float32(draw(within(bound)))
    if draw(st.booleans()):
        points["x"] = np.arange(n) * min(size, 100.0)
    return points


@st.composite
def poses(draw: st.DrawFn) -> tuple[float, ...]:
    size = draw(SIZES)
    place = [draw(within(size)) for _ in range(3)]
    speed = [draw(within(MAX_SPEED)), draw(within(MAX_SPEED)), draw(within(MAX_TURN))]
    return (*place, *draw(turns()), *speed)


STEPS = st.tuples(
    trajectories() | st.none(),
    poses(),
    within(MAX_TURN),
    within(MAX_ACCELERATION),
    st.sampled_from([(1, True), (2, True), (2, False)]),
    st.sampled_from([0.15, 0.15, 0.03, 0.0, 1e-9, 7.0, 1e5]),
)


@pytest.mark.parametrize("name", SETS)
@given(steps=st.lists(STEPS, min_size=1, max_size=6))
@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
def test_numbers_stay_numbers(name: str, steps: list[Any]) -> None:
    follower = TrajectoryFollower(firmware(**SETS[name]))
    now = START
    for trajectory, pose, steer, ax, mode, dt in steps:
        if trajectory is not None:
            follower.offer_trajectory(trajectory, now)
        assert follower.offer_odometry(*pose) is Refusal.ACCEPTED
        assert follower.offer_steering(steer) is Refusal.ACCEPTED
        assert follower.offer_acceleration(ax) is Refusal.ACCEPTED
        assert follower.offer_operation_mode(*mode) is Refusal.ACCEPTED
        now += dt
        follower.step(now)
        assert finite(follower)
