# SPDX-License-Identifier: Apache-2.0
"""The state machine: every state with every combination of conditions, and what a change resets."""

from __future__ import annotations

from itertools import product

import pytest

from safety_island.control.longitudinal_machine import next_state
from safety_island.control.status import LongitudinalState
from tests.control.longitudinal_rig import rig_in

DRIVE, STOPPING, STOPPED, EMERGENCY = LongitudinalState

CONDITIONS = [
    "smooth",
    "emergency",
    "under_control",
    "stopped",
    "stopping",
    "departing",
    "departing_far",
    "kept",
]

TABLE = {
    DRIVE: [
        ({"emergency": True}, EMERGENCY),
        ({"under_control": False, "stopped": True}, STOPPED),
        ({"smooth": True, "stopping": True}, STOPPING),
        ({"smooth": False, "stopped": True, "departing": False}, STOPPED),
    ],
    STOPPING: [
        ({"emergency": True}, EMERGENCY),
        ({"stopped": True}, STOPPED),
        ({"departing_far": True}, DRIVE),
    ],
    STOPPED: [({"departing": True, "kept": False}, DRIVE)],
    EMERGENCY: [
        ({"stopped": True}, STOPPED),
        ({"emergency": False, "under_control": False}, DRIVE),
    ],
}
"""From each state: what must hold and where it leads, the first that holds; else it stays."""


def by_table(state: LongitudinalState, holds: dict[str, bool]) -> LongitudinalState:
    for needed, target in TABLE[state]:
        if all(holds[name] == value for name, value in needed.items()):
            return target
    return state


@pytest.mark.parametrize("state", list(LongitudinalState))
def test_every_combination_of_conditions(state: LongitudinalState) -> None:
    for values in product((False, True), repeat=len(CONDITIONS)):
        holds = dict(zip(CONDITIONS, values, strict=True))
        assert next_state(int(state), *values) == by_table(state, holds), holds


@pytest.mark.parametrize("state", [DRIVE, STOPPING])
@pytest.mark.parametrize(("x", "after"), [(11.4, STOPPING), (11.6, EMERGENCY)])
def test_running_past_the_stop_point_is_an_emergency(
    state: LongitudinalState, x: float, after: LongitudinalState
) -> None:
    rig = rig_in(state)
    assert rig.tick(x=x, vx=1.0).lon_state == after


def test_an_overshoot_needs_its_option_and_a_standing_target() -> None:
    assert (
        rig_in(DRIVE, enable_overshoot_emergency=False).tick(x=12.0, vx=1.0).lon_state == STOPPING
    )
    rig = rig_in(DRIVE)
    rig.points["v"][22:41] = 1.0
    assert rig.tick(x=12.0, vx=1.0).lon_state == STOPPING, "it may go on from here"


def test_an_overshoot_does_not_leave_stopped() -> None:
    assert rig_in(STOPPED).tick(x=12.0, vx=1.0).lon_state == STOPPED


def test_an_emergency_ends_at_standstill_or_out_of_control() -> None:
    rig = rig_in(EMERGENCY)
    assert rig.tick(x=12.0, vx=1.0).lon_state == EMERGENCY, "still past the stop point"
    assert rig.tick(x=5.0, vx=1.0).lon_state == EMERGENCY, "under control it goes on"
    assert rig.tick(x=5.0, vx=1.0, enabled=False).lon_state == DRIVE
    rig = rig_in(EMERGENCY)
    rig.tick(x=12.0, vx=1.0)
    assert rig.tick(x=12.0, vx=0.0).lon_state == STOPPED


def test_standstill_counts_after_a_tenth_of_a_second_and_only_after_motion() -> None:
    rig = rig_in(EMERGENCY)
    for _ in range(9):
        assert rig.tick(x=12.0, vx=0.0).lon_state == EMERGENCY, "it never ran"
    rig.tick(x=12.0, vx=0.011)
    assert rig.tick(x=12.0, vx=0.009, dt=0.09).lon_state == EMERGENCY
    assert rig.tick(x=12.0, vx=-0.5, dt=0.02).lon_state == STOPPED, "against the gear"


@pytest.mark.parametrize(("mode", "enabled"), [(1, True), (2, False), (3, True), (4, False)])
def test_out_of_control_a_standing_vehicle_is_stopped_anywhere(mode: int, enabled: bool) -> None:
    rig = rig_in(DRIVE)
    assert rig.tick(x=1.0, vx=1.0, mode=mode, enabled=enabled).lon_state == DRIVE
    assert rig.tick(x=1.0, vx=0.0).lon_state == STOPPED


def test_under_control_a_standing_vehicle_goes_on_driving() -> None:
    rig = rig_in(DRIVE)
    rig.tick(x=1.0, vx=1.0)
    assert [rig.tick(x=1.0, vx=0.0).lon_state for _ in range(5)] == [DRIVE] * 5


def test_without_smooth_stop_it_drives_until_it_stands_near_the_stop_point() -> None:
    rig = rig_in(DRIVE, enable_smooth_stop=False)
    assert rig.tick(x=9.8, vx=0.5).lon_state == DRIVE
    assert rig.tick(x=9.8, vx=0.0).lon_state == STOPPED
    rig = rig_in(DRIVE, enable_smooth_stop=False)
    rig.tick(x=9.0, vx=0.5)
    assert rig.tick(x=9.0, vx=0.0).lon_state == DRIVE, "1 m is far enough to depart"


@pytest.mark.parametrize(("x", "after"), [(9.6, STOPPING), (9.4, STOPPING), (8.55, STOPPING)])
def test_stopping_goes_on_up_to_a_metre_and_a_half(x: float, after: LongitudinalState) -> None:
    assert rig_in(STOPPING).tick(x=x, vx=0.5).lon_state == after


@pytest.mark.parametrize("before", [STOPPED, STOPPING])
def test_a_departure_forgets_the_errors_of_the_drive_before(before: LongitudinalState) -> None:
    """The filtered error of speed begins at 0, so its first value is a tenth of the error."""
    rig = rig_in(before, enable_keep_stopped_until_steer_convergence=False)
    rig.s.pid.integral, rig.s.pid.error_prev, rig.s.pid.started = 2.0, 1.0, True
    rig.s.vel_error, rig.s.acc_error, rig.s.raw_acc = 9.0, 4.0, -0.75
    trace = rig.tick(x=5.0, vx=0.5)
    assert trace.lon_state == DRIVE
    assert trace.err_vel_filtered == pytest.approx(0.1 * 1.5, abs=1e-9)
    assert trace.pid_d == 0.0 and trace.pid_i <= 0.1 * 0.15 * 0.15 + 1e-9
    if before == STOPPED:
        assert abs(rig.s.acc_error) < 0.1, "nor does the acceleration remember"
