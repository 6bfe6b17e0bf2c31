# SPDX-License-Identifier: Apache-2.0
"""The lateral controller at rest: when the wheels are held, and on what."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.control.status import MpcStatus
from tests.control.lateral_rig import Rig, circle, make_points, on_path

HALF = -0.5


def standing(steer: float = -0.5, **overrides: object) -> Rig:
    """At rest on a path that ends here, wheels turned."""
    rig = on_path(make_points(np.arange(20.0), v=0.0), **({"input_delay": 0.3} | overrides))
    rig.place(10.0, vx=0.0)
    rig.steer(steer)
    return rig


def test_at_rest_the_wheels_stay_where_they_are() -> None:
    rig = standing()
    for trace in rig.ticks(12):
        assert trace.stopped
        assert (rig.angle, rig.rate) == (HALF, 0.0)
        assert list(rig.lat.delay[:2]) == [HALF, HALF]
        assert trace.raw_steer_cmd_prev == HALF
        assert not trace.is_steer_converged, "the other controller shall not start off"


@pytest.mark.parametrize(
    ("ego", "target", "stopped"),
    [(0.00099, 0.0, True), (0.00101, 0.0, False), (0.0, 0.00099, True), (0.0, 0.00101, False)],
)
def test_rest_is_below_a_millimetre_a_second_of_both(
    ego: float, target: float, stopped: bool
) -> None:
    for sign in (1.0, -1.0):
        rig = standing()
        rig.path(make_points(np.arange(20.0), v=sign * target))
        rig.place(10.0, vx=sign * ego)
        assert rig.tick().stopped == stopped


def test_the_target_is_that_of_the_nearest_received_point() -> None:
    """Not interpolated: beyond the middle the next one counts."""
    for x, stopped in ((10.4, False), (10.6, True)):
        rig = standing()
        rig.path(make_points(np.arange(20.0), v=np.where(np.arange(20) > 10, 0.0, 1.0)))
        rig.place(x, vx=0.0)
        assert rig.tick().stopped == stopped


def test_the_target_is_found_within_the_nearest_thresholds() -> None:
    """The way back is nearer and stands still, but faces the other way."""
    x = np.arange(20.0)
    there_and_back = make_points(
        np.concatenate([x, x[::-1]]),
        np.repeat([0.0, 0.4], 20),
        np.repeat([1.0, 0.0], 20),
        np.repeat([0.0, math.pi], 20),
    )
    limits = {"ego_nearest_dist_threshold": 3.0, "ego_nearest_yaw_threshold": 1.0}
    for settings, stopped in (({}, True), (limits, False)):
        rig = standing(admissible_yaw_error_rad=3.2, **settings)
        rig.path(there_and_back)
        rig.place(10.0, 0.3, vx=0.0)
        assert rig.tick().stopped == stopped


def test_the_previous_command_is_repeated_with_its_rate() -> None:
    """What was commanded on the way to the stop, not what is measured at it."""
    rig = on_path(circle(30.0, 40.0))
    rig.steer(0.05)
    rig.tick()
    angle, rate = rig.angle, rig.rate
    assert rate != 0.0
    rig.path(circle(30.0, 40.0, v=0.0))
    rig.place(vx=0.0)
    for trace in rig.ticks(3):
        assert trace.stopped
        assert (rig.angle, rig.rate) == (angle, rate)


def test_steering_goes_on_until_it_has_reached_the_previous_command() -> None:
    for keep, stopped in ((True, False), (False, True)):
        rig = standing(0.0, keep_steer_control_until_converged=keep)
        rig.tick()
        rig.steer(0.3)
        assert rig.tick().stopped == stopped
        rig.steer(0.09)
        assert rig.tick().stopped


def test_steering_goes_on_where_the_trajectory_is_new() -> None:
    rig = standing(0.0)
    assert rig.tick().stopped
    rig.path(make_points(np.arange(19.0), v=0.0))
    trace = rig.tick()
    assert trace.shape_changed and not trace.stopped


def test_rest_comes_before_failure() -> None:
    """A vehicle that stands too far from its path holds its wheels as well."""
    rig = standing()
    rig.place(10.0, 6.0, vx=0.0)
    trace = rig.tick()
    assert trace.mpc_status == MpcStatus.TOO_FAR and trace.stopped
    assert (rig.angle, rig.rate) == (HALF, 0.0)


def test_the_mpc_runs_on_at_rest() -> None:
    """Predictor and history see the commands that are not used."""
    rig = standing()
    for trace in rig.ticks(5):
        assert trace.stopped and trace.mpc_status == MpcStatus.SOLVED
        assert rig.lat.history_u[rig.lat.history_n - 1] == np.float32(trace.u[0])
    assert rig.lat.history_n == rig.lat.predictor_n == 5
