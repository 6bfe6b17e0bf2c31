# SPDX-License-Identifier: Apache-2.0
"""Far from the trajectory: the emergency command, and what it leaves alone."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.control.status import LongitudinalState
from tests.control.longitudinal_rig import Rig, cruise

DRIVE, STOPPING, STOPPED, EMERGENCY = LongitudinalState


@pytest.mark.parametrize(
    ("y", "yaw", "far"),
    [
        (2.99, 0.0, False),
        (3.01, 0.0, True),
        (-3.01, 0.0, True),
        (0.0, 0.785, False),
        (0.0, 0.786, True),
        (0.0, -0.786, True),
        (0.0, math.pi, True),
    ],
)
def test_three_metres_or_an_eighth_of_a_turn_is_far(y: float, yaw: float, far: bool) -> None:
    rig = cruise(1.0)
    rig.turn(yaw)
    trace = rig.tick(x=20.0, y=y, vx=1.0)
    assert trace.far_from_trajectory == far
    assert (trace.lon_state == EMERGENCY) == far
    assert trace.stuck_in_emergency == far
    assert trace.trans_dev == pytest.approx(abs(y), abs=1e-12)
    assert trace.rot_dev == pytest.approx(abs(yaw), abs=1e-12)


def test_the_yaw_deviation_wraps() -> None:
    rig = cruise(1.0)
    rig.points["qz"][:3], rig.points["qw"][:3] = math.sin(1.5), math.cos(1.5)
    rig.turn(-3.0)
    assert rig.tick(x=20.0, vx=1.0).rot_dev == pytest.approx(2 * math.pi - 6.0, abs=1e-12)


@pytest.mark.parametrize("state", list(LongitudinalState))
def test_every_state_goes_to_emergency(state: LongitudinalState) -> None:
    rig = cruise(1.0)
    rig.s.state = state
    assert rig.tick(y=9.0, vx=1.0).lon_state == EMERGENCY


@pytest.mark.parametrize("state", list(LongitudinalState))
def test_with_the_option_off_the_state_stays_and_the_command_goes_out(
    state: LongitudinalState,
) -> None:
    rig = cruise(1.0, enable_large_tracking_error_emergency=False)
    rig.s.state, rig.s.raw_vel, rig.s.raw_acc = state, 2.0, 0.5
    trace = rig.tick(y=9.0, vx=2.0)
    assert trace.lon_state == state
    assert trace.stuck_in_emergency == (state == EMERGENCY)
    assert rig.velocity == pytest.approx(2.0 - 5.0 * 0.15, abs=1e-7)
    assert rig.acceleration == pytest.approx(0.5 - 3.0 * 0.15, abs=1e-7)


@pytest.mark.parametrize(("speed", "then"), [(2.0, 1.25), (0.5, 0.0), (-2.0, -1.25), (-0.5, 0.0)])
def test_the_emergency_speed_goes_to_zero_by_five_a_second(speed: float, then: float) -> None:
    rig = cruise(1.0)
    rig.s.raw_vel = speed
    rig.tick(y=9.0)
    assert rig.velocity == pytest.approx(then, abs=1e-7)


def test_the_emergency_braking_builds_up_to_five_and_stays_there() -> None:
    rig = cruise(1.0)
    accelerations = [rig.tick(y=9.0, vx=1.0).prev_acc for _ in range(13)]
    expected = [max(-0.45 * i, -5.0) for i in range(1, 14)]
    assert accelerations == pytest.approx(expected, abs=1e-9)
    assert rig.trace[0].acc_acc_limited == -5.0
    assert not rig.trace[0].jerk_limited


def test_the_emergency_braking_respects_the_smallest_acceleration() -> None:
    rig = cruise(1.0, min_acc=-0.2)
    trace = rig.tick(y=9.0, vx=1.0)
    assert (trace.acc_acc_limited, trace.acc_limited) == (-0.2, True)
    assert trace.prev_acc == pytest.approx(-0.2, abs=1e-12)


def test_the_output_memory_is_set_without_its_limit() -> None:
    rig = cruise(1.0)
    rig.s.prev_acc = 90.0
    assert rig.tick(y=9.0, vx=1.0).prev_acc == pytest.approx(-0.45, abs=1e-12)


def test_nothing_else_is_touched() -> None:
    rig = cruise(2.0, lpf_pitch_gain=0.5)
    rig.turn(pitch=0.05)
    for _ in range(3):
        near = rig.tick(vx=1.5, ax=0.3).copy()
    names = "vel_error acc_error pitch commands_n pid gear_forward moved_before under_control_prev"
    before = [rig.state[name].tobytes() for name in names.split()]
    rig.turn(pitch=-0.4)
    far = rig.tick(y=9.0, vx=-1.0, ax=-3.0, mode=1)
    assert [rig.state[name].tobytes() for name in names.split()] == before
    near_only = ["target_vel", "target_acc", "nearest_vel", "pred_vel", "slope_angle", "pid_p"]
    for name in [*near_only, "acc_fb_applied"]:
        assert far[name] == near[name], name
    assert rig.s.speeds_v[0] == -1.0, "the speed is remembered"
    assert rig.s.time_prev == rig.now
    assert np.isfinite(far.stop_dist)


def test_near_again_and_standing_ends_the_emergency() -> None:
    rig = cruise(1.0)
    rig.tick(vx=1.0)
    for _ in range(9):
        trace = rig.tick(y=9.0, vx=0.0)
    assert trace.stuck_in_emergency, "at standstill for long, but far"
    trace = rig.tick(y=0.0, vx=0.0)
    assert (trace.lon_state, trace.stuck_in_emergency) == (STOPPED, False)


def test_near_again_in_motion_goes_on_braking() -> None:
    rig = Rig()
    rig.road([0.0, 50.0], 1.0)
    rig.tick(y=9.0, vx=1.0)
    trace = rig.tick(y=0.0, vx=1.0)
    assert (trace.lon_state, trace.far_from_trajectory) == (EMERGENCY, False)
    assert trace.acc_jerk_limited == pytest.approx(-0.9, abs=1e-12)
