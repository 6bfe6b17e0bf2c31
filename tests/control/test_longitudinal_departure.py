# SPDX-License-Identifier: Apache-2.0
"""How a stop is left: what it resets, and the wait for the steering."""

from __future__ import annotations

import pytest

from safety_island.control.status import LongitudinalState
from tests.control.longitudinal_rig import cruise, rig_in

DRIVE, STOPPING, STOPPED, EMERGENCY = LongitudinalState


def test_leaving_stopping_resets_the_pid_and_lifts_the_last_output() -> None:
    rig = rig_in(STOPPING)
    rig.s.pid.integral, rig.s.vel_error, rig.s.acc_error = 2.0, 3.0, 0.5
    rig.s.raw_acc, rig.s.prev_acc = -1.0, -2.0
    trace = rig.tick(x=8.0, vx=2.0)
    assert trace.lon_state == DRIVE
    assert (rig.s.pid.integral, rig.s.vel_error) == (0.0, 0.0)
    assert trace.acc_jerk_limited == pytest.approx(-1.0 + 2.0 * 0.15, abs=1e-15)
    assert trace.prev_acc == pytest.approx(-0.7, abs=1e-15)
    assert rig.s.acc_error == pytest.approx(0.98 * 0.5 + 0.02 * 0.7, abs=1e-15), "not reset"


def test_the_last_output_is_lifted_to_zero_at_least() -> None:
    """With a limit of 1 m/s^3 the output can fall from the lifted 0 by 0.15 at most."""
    rig = rig_in(STOPPING, max_acc_cmd_diff=1.0)
    rig.s.raw_acc, rig.s.prev_acc = -1.0, -3.0
    trace = rig.tick(x=8.0, vx=2.0)
    assert trace.prev_acc == pytest.approx(-0.15, abs=1e-15)
    assert trace.diff_limited


def test_leaving_stopped_resets_the_acceleration_filter_too() -> None:
    rig = cruise(v=1.0)
    rig.s.pid.integral, rig.s.vel_error, rig.s.acc_error = 2.0, 3.0, 0.5
    trace = rig.tick(vx=1.0)
    assert trace.lon_state == DRIVE
    assert (rig.s.pid.integral, rig.s.vel_error, rig.s.acc_error) == (0.0, 0.0, 0.0)


def test_a_departure_waits_for_two_converged_records_in_a_row() -> None:
    rig = rig_in(STOPPED)
    converged = [True, False, True, True, True]
    states, held = [], []
    for value in converged:
        rig.s.is_steer_converged = value
        trace = rig.tick()
        states.append(trace.lon_state)
        held.append(bool(trace.slow_start_held))
    assert states == [STOPPED, STOPPED, STOPPED, DRIVE, DRIVE]
    assert held == [True, True, True, False, False]


def test_records_are_renewed_in_departing_ticks_only_and_forgotten_outside_stopped() -> None:
    rig = rig_in(STOPPED)
    rig.s.is_steer_converged = True
    rig.tick()
    rig.s.is_steer_converged = False
    assert rig.tick(x=9.8).lon_state == STOPPED, "not departing: no record"
    rig.s.is_steer_converged = True
    assert rig.tick(x=0.0).lon_state == DRIVE
    rig.s.state = STOPPED
    assert rig.tick().lon_state == DRIVE, "the record of this stop was not forgotten yet"
    rig.tick()
    rig.s.state = STOPPED
    assert rig.tick().lon_state == STOPPED


def test_rolling_counts_as_converged() -> None:
    rig = rig_in(STOPPED)
    rig.s.is_steer_converged = False
    assert rig.tick(vx=0.002).lon_state == STOPPED, "no record yet"
    assert rig.tick(vx=0.002).lon_state == DRIVE


def test_a_departure_needs_no_autonomous_mode() -> None:
    assert cruise().tick(vx=0.0, mode=3).lon_state == DRIVE
