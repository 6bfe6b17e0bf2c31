# SPDX-License-Identifier: Apache-2.0
"""Commands and limits of DRIVE and STOPPING that no recorded run exercises."""

from __future__ import annotations

from typing import Any

import pytest

from safety_island.control.status import LongitudinalState, SmoothStopMode
from tests.control.longitudinal_rig import PERIOD, Rig, cruise

DRIVE, STOPPING, STOPPED, EMERGENCY = LongitudinalState


def driving(v: float = 2.0, acc: float = 0.0, **overrides: Any) -> Rig:
    """A rig in DRIVE whose trajectory asks for a speed and an acceleration."""
    rig = cruise(v, **overrides)
    rig.points["acc"][:3] = acc
    rig.s.state = DRIVE
    return rig


@pytest.mark.parametrize(
    ("acc", "clipped", "first"), [(9.0, 3.0, 2.0 * PERIOD), (-9.0, -5.0, -5.0 * PERIOD)]
)
def test_acceleration_is_clipped_then_its_jerk_limited(
    acc: float, clipped: float, first: float
) -> None:
    rig = driving(2.0, acc)
    trace = rig.tick(vx=2.0)
    assert (trace.acc_pid_applied, trace.acc_acc_limited) == (acc, clipped)
    assert trace.acc_jerk_limited == pytest.approx(first, abs=1e-12)
    assert trace.acc_limited and trace.jerk_limited
    for _ in range(12):
        trace = rig.tick(vx=2.0)
    assert trace.prev_acc == pytest.approx(clipped, abs=1e-12)
    assert trace.acc_limited and not trace.jerk_limited


def test_the_proportional_term_saturates_and_so_does_the_sum() -> None:
    rig = driving(5.0, max_jerk=99.0, kp=4.0, ki=1.0)
    trace = rig.tick(vx=2.0)  # filtered error 0.3
    assert trace.pid_p == 1.0
    assert trace.pid_i == pytest.approx(0.3 * PERIOD, abs=1e-12)
    assert trace.acc_pid_applied == 1.0


def test_the_derivative_acts_from_the_second_tick_on() -> None:
    rig = driving(3.0, ki=0.0, kd=0.1, max_d_effort=0.5, min_d_effort=-0.5, max_jerk=99.0)
    assert rig.tick(vx=2.0).pid_d == 0.0
    trace = rig.tick(vx=2.0)  # filtered error 0.1, then 0.19
    assert trace.pid_d == pytest.approx(0.1 * 0.09 / PERIOD, abs=1e-12)
    assert trace.acc_pid_applied == pytest.approx(0.19 + 0.06, abs=1e-12)
    assert rig.tick(vx=-20.0).pid_d == 0.5


@pytest.mark.parametrize(("option", "grows"), [(True, True), (False, False)])
def test_a_vehicle_that_is_stuck_integrates_after_two_seconds(option: bool, grows: bool) -> None:
    """Not above the speed threshold; ticks 0.25 s apart, the ninth is 2 s after the first."""
    rig = driving(1.0, ctrl_period=0.25, enable_integration_at_low_speed=option)
    terms = [float(rig.tick(dt=0.25, vx=0.5).pid_i) for _ in range(9)]
    assert terms[:8] == [0.0] * 8
    error = 0.5 * (1 - 0.9**9)
    assert terms[8] == pytest.approx(0.1 * error * 0.25 if grows else 0.0, abs=1e-12)


@pytest.mark.parametrize(("mode", "enabled"), [(1, True), (2, False)])
def test_out_of_control_nothing_is_integrated(mode: int, enabled: bool) -> None:
    rig = driving(1.0, enable_integration_at_low_speed=True)
    for v in (0.8, 0.3):
        for _ in range(20):
            assert rig.tick(vx=v, mode=mode, enabled=enabled).pid_i == 0.0


def test_losing_control_restarts_the_two_seconds() -> None:
    rig = driving(1.0, ctrl_period=0.25, enable_integration_at_low_speed=True)
    for _ in range(8):
        rig.tick(dt=0.25, vx=0.5)
    rig.tick(dt=0.25, enabled=False)
    assert rig.tick(dt=0.25, enabled=True).pid_i == 0.0
    for _ in range(7):
        assert rig.tick(dt=0.25).pid_i == 0.0
    assert rig.tick(dt=0.25).pid_i > 0.0


def test_a_gear_change_resets_the_pid_but_not_the_filter() -> None:
    rig = driving(2.0)
    for _ in range(4):
        rig.tick(vx=1.0)
    error = 1 - 0.9**4
    assert rig.s.vel_error == pytest.approx(error, abs=1e-12)
    rig.points["v"][:3] = -1.0
    trace = rig.tick(vx=1.0)
    assert not trace.gear_forward
    error = 0.9 * error + 0.1 * 2.0
    assert trace.err_vel_filtered == pytest.approx(error, abs=1e-12)
    assert trace.pid_i == pytest.approx(0.1 * error * PERIOD, abs=1e-12), "a new integral"
    assert trace.pid_d == 0.0
    rig.points["v"][:3] = 1e-5
    assert not rig.tick(vx=0.0).gear_forward, "a target that stands leaves the gear"
    rig.points["v"][:3] = 2e-5
    assert rig.tick(vx=0.0).gear_forward


@pytest.mark.parametrize(
    ("v", "correct", "error"),
    [(2.0, False, 0.8), (2.0, True, 0.8), (-2.0, False, 0.8), (-2.0, True, -0.8)],
)
def test_acceleration_feedback_and_its_sign_in_reverse(
    v: float, correct: bool, error: float
) -> None:
    """Measured 0.8 along body x, nothing commanded: in reverse the vehicle is slowing down."""
    rig = driving(v, acc_feedback_gain=0.5, lpf_acc_error_gain=0.75, correct_reverse_signs=correct)
    trace = rig.tick(vx=v, ax=0.8)
    assert trace.acc_jerk_limited == 0.0
    assert trace.acc_fb_applied == pytest.approx(-0.5 * 0.25 * error, abs=1e-12)
    trace = rig.tick(vx=v, ax=0.8)
    assert trace.acc_fb_applied == pytest.approx(-0.5 * (1 - 0.75**2) * error, abs=1e-12)


RAMP = [2.0, 2.0, 1.5, 1.0, 0.5, 0.0, 0.0]
BRAKE = [0.1, 0.0, -0.7, -0.6, -0.5, -0.4, 0.0]  # eases toward the stop point at 50 m


@pytest.mark.parametrize(
    ("x", "enabled", "least", "held"),
    [
        (30.0, True, -0.2, -0.2),  # on the ramp: as the parameter says
        (30.0, True, -0.9, -0.7),  # but not below the least of the ramp
        (20.5, True, -0.9, -0.7),
        (19.0, True, -0.9, None),  # before its strongest braking, at 20 m
        (30.0, False, -0.2, None),
    ],
)
def test_brake_keeping_holds_the_ramps_braking(
    x: float, enabled: bool, least: float, held: float | None
) -> None:
    """The error asks for more speed; the ramp begins where its braking is strongest."""
    rig = Rig(enable_brake_keeping_before_stop=enabled, brake_keeping_acc=least, min_jerk=-99.0)
    rig.road([10.0 * i for i in range(7)], RAMP, BRAKE)
    rig.s.state = DRIVE
    rig.s.vel_error = 9.0
    trace = rig.tick(x=x, vx=0.5)
    assert trace.brake_keeping == (held is not None)
    expected = trace.acc_pid_applied if held is None else held
    assert trace.acc_acc_limited == pytest.approx(expected, abs=1e-7)


def test_a_ramp_may_reach_back_to_the_first_point() -> None:
    rig = Rig(enable_brake_keeping_before_stop=True, brake_keeping_acc=-0.9)
    rig.road([10.0 * i for i in range(7)], RAMP, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.0])
    rig.s.state, rig.s.vel_error = DRIVE, 9.0
    assert rig.tick(x=5.0, vx=0.5).acc_acc_limited == pytest.approx(0.1, abs=1e-7)


def test_brake_keeping_without_a_stop_point_or_with_enough_braking_does_nothing() -> None:
    rig = Rig(enable_brake_keeping_before_stop=True)
    rig.road([10.0 * i for i in range(7)], 1.0, BRAKE)
    rig.s.state, rig.s.vel_error = DRIVE, 9.0
    assert not rig.tick(x=30.0, vx=0.5).brake_keeping
    rig.road([10.0 * i for i in range(7)], RAMP, BRAKE)
    rig.s.vel_error = -9.0
    assert not rig.tick(x=30.0, vx=0.5).brake_keeping


def test_limits_are_told_for_one_tick_only() -> None:
    rig = driving(2.0, 9.0)
    rig.tick(vx=2.0)
    rig.points["acc"][:3] = 0.3
    trace = rig.tick(vx=2.0)
    flags = "acc_limited jerk_limited diff_limited pitch_limited brake_keeping far_from_trajectory"
    assert [bool(trace[name]) for name in flags.split()] == [False] * 6
    assert trace.smooth_stop_mode == SmoothStopMode.NONE
