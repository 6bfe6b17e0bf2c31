# SPDX-License-Identifier: Apache-2.0
"""Slope compensation: its three sources, its sign in both gears, its limits."""

from __future__ import annotations

import math
from typing import Any

import pytest

from safety_island.control.slope import body_pitch
from safety_island.control.status import LongitudinalState
from tests.control.longitudinal_rig import Rig

UP = 0.05
PULL = 9.81 * math.sin(UP)


def hill(v: float, up: float = UP, **overrides: Any) -> Rig:
    """A rig in DRIVE at the target speed on a road that climbs along +x."""
    rig = Rig(**({"lpf_pitch_gain": 0.0} | overrides))
    x = [float(i) for i in range(31)]
    rig.road(x, v, z=[math.tan(up) * i for i in x])
    rig.s.state = LongitudinalState.DRIVE
    rig.turn(pitch=up)
    rig.inputs[0].x, rig.inputs[0].z, rig.inputs[0].vx = 10.0, 10 * math.tan(up), v
    return rig


@pytest.mark.parametrize("yaw", [0.0, 1.0, 3.0, -2.0])
@pytest.mark.parametrize("pitch", [0.3, 0.0, -0.4])
def test_the_body_pitch_is_positive_uphill_whatever_the_heading(yaw: float, pitch: float) -> None:
    rig = Rig()
    rig.turn(yaw, pitch)
    u = rig.inputs[0]
    assert body_pitch(u.qx, u.qy, u.qz, u.qw) == pytest.approx(pitch, abs=1e-15)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_vertical_body_has_a_pitch_of_a_quarter_turn(sign: float) -> None:
    side = math.sqrt(0.5) + 1e-9  # a little beyond a unit quaternion
    assert body_pitch(0.0, -sign * side, 0.0, side) == pytest.approx(sign * math.pi / 2)


@pytest.mark.parametrize("source", ["raw_pitch", "trajectory_pitch", "trajectory_adaptive"])
@pytest.mark.parametrize("up", [UP, -UP])
def test_uphill_forward_takes_more_acceleration_from_every_source(source: str, up: float) -> None:
    trace = hill(2.0, up, slope_source=source).tick()
    assert trace.slope_angle == pytest.approx(up, abs=1e-12)
    assert trace.acc_slope_applied == pytest.approx(math.copysign(PULL, up), abs=1e-12)


@pytest.mark.parametrize(
    ("source", "correct", "sign"),
    [
        ("raw_pitch", False, -1.0),  # the body points uphill: in reverse gravity helps
        ("raw_pitch", True, -1.0),
        ("trajectory_pitch", False, -1.0),  # the road climbs as it is travelled: wrong
        ("trajectory_pitch", True, 1.0),
    ],
)
def test_the_sign_in_reverse(source: str, correct: bool, sign: float) -> None:
    trace = hill(-2.0, slope_source=source, correct_reverse_signs=correct).tick()
    assert not trace.gear_forward
    assert trace.acc_slope_applied == pytest.approx(sign * PULL, abs=1e-12)


@pytest.mark.parametrize(("v", "from_trajectory"), [(1.1, True), (1.0, False), (-5.0, False)])
def test_adaptive_takes_the_trajectory_above_a_signed_speed(
    v: float, from_trajectory: bool
) -> None:
    rig = hill(v, slope_source="trajectory_adaptive")
    rig.turn(pitch=-0.03)
    expected = UP if from_trajectory else -0.03
    assert rig.tick().slope_angle == pytest.approx(expected, abs=1e-12)


def test_the_pitch_filter_starts_at_zero_and_always_advances() -> None:
    for source in ("raw_pitch", "trajectory_pitch", "trajectory_adaptive"):
        rig = hill(2.0, slope_source=source, lpf_pitch_gain=0.95)
        rig.tick()
        rig.tick()
        assert rig.s.pitch == pytest.approx((1 - 0.95**2) * UP, abs=1e-12)


@pytest.mark.parametrize(("up", "limited"), [(0.2, 0.1), (-0.2, -0.1)])
def test_the_pitch_is_clipped(up: float, limited: float) -> None:
    trace = hill(2.0, up).tick()
    assert trace.pitch_limited
    assert trace.slope_angle == pytest.approx(up, abs=1e-12)
    assert trace.acc_slope_applied == pytest.approx(9.81 * math.sin(limited), abs=1e-12)


def test_it_can_be_turned_off() -> None:
    trace = hill(2.0, 0.2, enable_slope_compensation=False).tick()
    assert trace.acc_slope_applied == trace.acc_fb_applied == 0.0
    assert not trace.pitch_limited


@pytest.mark.parametrize(("v", "sign"), [(2.0, 1.0), (-2.0, -1.0)])
def test_an_emergency_on_a_slope_is_compensated_too(v: float, sign: float) -> None:
    rig = hill(v)
    rig.s.state = LongitudinalState.EMERGENCY
    trace = rig.tick()
    assert trace.lon_state == LongitudinalState.EMERGENCY
    assert trace.acc_jerk_limited == pytest.approx(-0.45, abs=1e-15)
    assert trace.acc_slope_applied == pytest.approx(-0.45 + sign * PULL, abs=1e-12)


def test_a_stopped_vehicle_is_held_without_slope_and_starts_against_it() -> None:
    rig = hill(2.0, enable_keep_stopped_until_steer_convergence=False)
    rig.s.state = LongitudinalState.STOPPED
    trace = rig.tick(vx=0.0)
    assert trace.lon_state == LongitudinalState.DRIVE
    assert trace.acc_fb_applied == pytest.approx(0.2, abs=1e-12)  # 0.1 of the error of 2 m/s
    assert trace.acc_slope_applied == pytest.approx(0.2 + PULL, abs=1e-12)
    rig = hill(2.0)
    rig.s.state = LongitudinalState.STOPPED
    assert rig.tick(vx=0.0).acc_slope_applied == -3.4
