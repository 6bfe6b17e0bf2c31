# SPDX-License-Identifier: Apache-2.0
"""The longitudinal tick: what Autoware's own suite asks of it, with numbers worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from safety_island.control.status import LongitudinalState
from tests.control.longitudinal_rig import PERIOD, cruise

DRIVE, STOPPING, STOPPED, EMERGENCY = LongitudinalState


def test_at_the_target_speed_nothing_is_asked_for() -> None:
    rig = cruise(1.0)
    for _ in range(2):
        trace = rig.tick(vx=1.0)
        assert (rig.velocity, rig.acceleration) == (1.0, 0.0)
    assert (rig.status, trace.lon_state) == (DRIVE, DRIVE)
    assert rig.command[0].longitudinal_stamp == rig.now


def test_too_fast_slows_down() -> None:
    """Error -0.5: low-passed -0.05, -0.095; I = 0.1 of its sum over time."""
    rig = cruise(0.5)
    trace = rig.tick(vx=1.0)
    assert (trace.err_vel_filtered, trace.pid_p) == pytest.approx((-0.05, -0.05), abs=1e-15)
    assert trace.pid_i == pytest.approx(-0.1 * 0.05 * PERIOD, abs=1e-15)
    assert trace.acc_pid_applied == pytest.approx(-0.05075, abs=1e-15)
    assert (rig.velocity, rig.acceleration) == pytest.approx((0.5, -0.05075), abs=1e-8)
    trace = rig.tick(vx=1.0)
    assert trace.acc_pid_applied == pytest.approx(-0.095 - 0.1 * 0.145 * PERIOD, abs=1e-15)
    assert rig.acceleration == pytest.approx(-0.097175, abs=1e-8)


def test_too_slow_speeds_up() -> None:
    """At 0.5 m/s nothing is integrated: the speed has to be above the threshold."""
    rig = cruise(1.0)
    rig.tick(vx=0.5)
    assert (rig.velocity, rig.acceleration) == pytest.approx((1.0, 0.05), abs=1e-8)
    rig.tick(vx=0.5)
    assert rig.acceleration == pytest.approx(0.095, abs=1e-8)


def test_a_standing_target_is_held() -> None:
    rig = cruise(0.0)
    trace = rig.tick(vx=0.0)
    assert (rig.status, rig.velocity) == (STOPPED, 0.0)
    assert rig.acceleration == pytest.approx(-3.4, abs=1e-6)
    assert trace.acc_acc_limited == trace.acc_jerk_limited == trace.acc_slope_applied == -3.4
    assert (trace.prev_raw_acc, trace.prev_raw_vel, trace.prev_acc) == (0.0, 0.0, -3.4)
    assert np.isnan(trace.acc_fb_applied) and np.isnan(trace.pid_p), "not set yet"
    assert trace.stop_dist == 0.0


def test_reverse_accelerates_in_the_gears_direction() -> None:
    rig = cruise(-1.0)
    trace = rig.tick(vx=0.0)
    assert (rig.velocity, rig.acceleration) == pytest.approx((-1.0, 0.1), abs=1e-8)
    assert not trace.gear_forward


@pytest.mark.parametrize("option", [True, False])
def test_unconverged_steering_holds_the_vehicle_when_asked_to(option: bool) -> None:
    rig = cruise(1.0, enable_keep_stopped_until_steer_convergence=option)
    for _ in range(3):
        trace = rig.tick(vx=0.0)
        assert rig.velocity == (0.0 if option else 1.0)
        assert trace.slow_start_held == option


def test_the_first_tick_takes_the_period_and_later_ones_the_time_between() -> None:
    """Full braking against the jerk limit of -5 shows the step: -5 dt a tick."""
    for dt, counted in ((0.2, 0.2), (0.31, 0.3), (5.0, 0.3), (0.07, 0.075), (0.0, 0.075)):
        rig = cruise(-10.0, kp=9.0, min_out=-9.0, min_p_effort=-9.0)
        rig.s.state = DRIVE
        rig.road([0.0, 50.0, 100.0], 0.1)
        trace = rig.tick(vx=50.0)
        assert trace.acc_jerk_limited == pytest.approx(-5.0 * PERIOD, abs=1e-12)
        assert trace.jerk_limited
        first = trace.acc_jerk_limited
        assert rig.tick(dt=dt).acc_jerk_limited - first == pytest.approx(-5.0 * counted, abs=1e-9)


def test_feed_forward_is_scaled_by_the_speed_ratio() -> None:
    for v, target, scale in ((1.0, 2.0, 0.5), (0.1, 2.0, 0.5), (3.0, 2.0, 1.5), (9.0, 2.0, 2.0)):
        rig = cruise(target)
        rig.points["acc"][:3] = 0.4
        rig.s.state = DRIVE
        trace = rig.tick(vx=v)
        assert trace.ff_scale == pytest.approx(scale, abs=1e-15)
        assert trace.acc_ff == pytest.approx(float(np.float32(0.4)) * scale, abs=1e-15)


def test_a_crawling_target_counts_as_a_tenth_in_the_scale() -> None:
    rig = cruise(0.05)
    rig.s.state = DRIVE
    assert rig.tick(vx=0.1).ff_scale == pytest.approx(1.0, abs=1e-15)


def test_the_target_lies_where_the_delay_will_bring_the_vehicle() -> None:
    """2 m/s for 0.17 s: 0.34 m ahead on a ramp of 0.1 (m/s)/m from 2 m/s at the ego."""
    rig = cruise()
    rig.road([0.0, 10.0, 20.0], [1.5, 2.5, 3.5])
    trace = rig.tick(x=5.0, vx=2.0)
    assert trace.pred_vel == 2.0
    assert trace.nearest_vel == pytest.approx(2.0, abs=1e-7)
    assert trace.target_vel == pytest.approx(2.034, abs=1e-6)
    assert rig.velocity == pytest.approx(2.034, abs=1e-6)


@pytest.mark.parametrize(("v", "target"), [(0.058, 2.0), (0.06, 2.00102)])
def test_a_run_of_a_centimetre_does_not_move_the_target(v: float, target: float) -> None:
    """0.058 m/s runs 9.86 mm, 0.06 m/s 10.2 mm."""
    rig = cruise()
    rig.road([0.0, 10.0, 20.0], [1.5, 2.5, 3.5])
    assert rig.tick(x=5.0, vx=v).target_vel == pytest.approx(target, abs=1e-6)


def test_past_the_end_the_last_point_is_the_target() -> None:
    rig = cruise(1.0)
    trace = rig.tick(x=102.0, vx=1.0)
    assert (trace.stop_dist, trace.trans_dev) == (0.0, 2.0)
    rig.s.state = DRIVE
    assert rig.tick(x=101.0, vx=1.0).target_vel == 1.0


def test_the_output_changes_by_fifty_a_second_at_most() -> None:
    rig = cruise(0.0, ctrl_period=0.03)
    outputs = [rig.tick(vx=0.0, dt=0.03).prev_acc for _ in range(3)]
    assert outputs == pytest.approx([-1.5, -3.0, -3.4], abs=1e-9)
    assert not rig.trace[0].diff_limited
    assert cruise(0.0, ctrl_period=0.03).tick(vx=0.0).diff_limited
