# SPDX-License-Identifier: Apache-2.0
"""The MPC: the cases of Autoware's own suite, when it gives up, what it takes as its state."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from safety_island.control.status import MpcStatus, VehicleModel
from tests.control.lateral_rig import Rig, circle, line, make_points, on_path
from tests.control.vehicles import MODELS

"""The settings of that suite; horizon 50, steps of 0.1 s and of 0.1 m as in the firmware."""


@pytest.mark.parametrize(
    ("delay", "period", "entries"),
    [(0.0, 0.15, 0), (0.07, 0.15, 0), (0.08, 0.15, 1), (0.24, 0.15, 2), (0.24, 0.03, 8)],
)
def test_the_delay_is_rounded_to_whole_periods(delay: float, period: float, entries: int) -> None:
    assert on_path(line(9.0), input_delay=delay, ctrl_period=period).lat.delay_n == entries


def test_the_delay_buffer_holds_the_filtered_commands_oldest_first() -> None:
    rig = on_path(line(60.0), input_delay=0.3)
    rig.place(5.0, 1.0)
    given = []
    for _ in rig.ticks(4):
        given.append(np.float32(rig.angle))
        assert list(rig.lat.delay[:2]) == ([np.float32(0.0)] * 2 + given)[-2:]
    rig.place(5.0, 7.0)
    rig.tick()
    assert list(rig.lat.delay[:2]) == given[-2:], "a failed tick sends nothing new"


def lost(rig: Rig) -> bytes:
    """Everything that a failed tick must not touch."""
    names = (
        *("steering_filter", "lateral_filter", "yaw_filter", "delay", "predictor_n"),
        *("predictor_u", "predictor_t", "history_n", "history_u", "history_t"),
    )
    return b"".join(rig.lat[name].tobytes() for name in names)


@pytest.mark.parametrize(
    ("overrides", "place", "status"),
    [
        ({}, (5.0, 4.99, 0.0), MpcStatus.SOLVED),
        ({}, (5.0, 5.01, 0.0), MpcStatus.TOO_FAR),
        ({}, (-5.01, 0.0, 0.0), MpcStatus.TOO_FAR),
        ({}, (64.99, 0.0, 0.0), MpcStatus.SOLVED),
        ({}, (65.1, 0.0, 0.0), MpcStatus.TOO_FAR),
        ({}, (5.0, 0.0, 1.569), MpcStatus.SOLVED),
        ({}, (5.0, 0.0, 1.571), MpcStatus.YAW_ERROR_TOO_LARGE),
        ({}, (5.0, 0.0, -1.571), MpcStatus.YAW_ERROR_TOO_LARGE),
        ({}, (5.0, 0.0, math.pi), MpcStatus.YAW_ERROR_TOO_LARGE),
        ({}, (5.0, 5.01, 1.571), MpcStatus.TOO_FAR),  # the distance is looked at first
        ({"admissible_yaw_error_rad": 0.3}, (5.0, 0.0, 0.31), MpcStatus.YAW_ERROR_TOO_LARGE),
        ({"admissible_position_error": 1.0}, (5.0, -1.01, 0.0), MpcStatus.TOO_FAR),
    ],
)
def test_it_gives_up_beyond_the_admissible_errors(
    overrides: dict[str, float], place: tuple[float, float, float], status: MpcStatus
) -> None:
    """The errors are told all the same."""
    rig = on_path(line(60.0), input_delay=0.15, **overrides)
    rig.tick()
    before = lost(rig)
    rig.place(*place)
    trace = rig.tick()
    assert rig.status is status
    assert trace.mpc_status == trace.solver_status == status
    if 0.0 < place[0] < 60.0:
        assert trace.lateral_error == pytest.approx(place[1], abs=1e-12)
        assert abs(trace.yaw_error) == pytest.approx(abs(place[2]), abs=1e-12)
    assert (lost(rig) == before) == (status is not MpcStatus.SOLVED)


def test_the_errors_are_those_of_the_projection() -> None:
    """On a circle to the left: outside is to the right, which is negative."""
    radius, s = 20.0, 10.0
    rig = on_path(circle(radius, 40.0, 0.1))
    angle, away = s / radius, 0.5
    place = (radius + away) * math.sin(angle), radius - (radius + away) * math.cos(angle)
    rig.place(*place, angle + 0.1)
    trace = rig.tick()
    assert trace.lateral_error == pytest.approx(-away, abs=1e-4)
    assert trace.yaw_error == pytest.approx(0.1, abs=1e-4)
    assert list(rig.lat.x0[:3]) == [trace.lateral_error, trace.yaw_error, 0.0]


@pytest.mark.parametrize("offset", [0.01, 0.05, 0.099])
def test_the_place_between_two_points_is_interpolated(offset: float) -> None:
    """The reference is anchored at a projection onto a coarse path, the ego's foot is another."""
    rig = on_path(make_points([0.0, 3.0, 6.0, 9.0, 12.0], [0.0, 0.3, 0.0, -0.3, 0.0]))
    rig.place(4.0 + offset, 1.0)
    trace = rig.tick()
    lat = rig.lat
    a, b = ((lat.rx[i], lat.ry[i]) for i in (lat.segment, lat.segment + 1))
    ratio = np.dot(np.subtract(b, a), np.subtract((4.0 + offset, 1.0), a)) / math.dist(a, b) ** 2
    foot = np.add(a, ratio * np.subtract(b, a))
    assert 0.0 <= ratio <= 1.0
    assert math.dist(foot, (4.0 + offset, 1.0)) == pytest.approx(trace.lateral_error, rel=1e-3)
    assert lat.nearest_time == pytest.approx(ratio * lat.wt[1], rel=1e-12)


def test_the_rates_of_the_errors_are_differences_over_a_period_then_filtered() -> None:
    """The firmware's 10 Hz are above the Nyquist frequency at 0.15 s, so nothing is filtered."""
    rig = on_path(line(60.0), **MODELS["dynamics"])
    rig.place(5.0, 0.3, 0.1)
    rig.tick()
    np.testing.assert_allclose(rig.lat.x0, [0.3, 0.3 / 0.15, 0.1, 0.1 / 0.15], rtol=1e-12)
    rig.place(5.0, 0.2, 0.15)
    rig.tick()
    np.testing.assert_allclose(rig.lat.x0, [0.2, -0.1 / 0.15, 0.15, 0.05 / 0.15], rtol=1e-9)
    smooth = on_path(line(60.0), error_deriv_lpf_cutoff_hz=1.0, **MODELS["dynamics"])
    smooth.place(5.0, 0.3, 0.1)
    smooth.tick()
    xi = 1.0 / math.tan(math.pi * 0.15)
    b0 = 1.0 / (1.0 + math.sqrt(2.0) * xi + xi * xi)
    np.testing.assert_allclose(smooth.lat.x0[1::2], [b0 * 2.0, b0 * 0.1 / 0.15], rtol=1e-12)


def kinematic_rate(rig: Rig) -> float:
    """The steering lag answers to the unclamped solution for one prediction step."""
    dt, tau = rig.lat.prediction_dt, rig.parameters.lateral.vehicle_model_steer_tau
    decay = (1.0 - dt / (2 * tau)) / (1.0 + dt / (2 * tau))
    gain = dt / tau / (1.0 + dt / (2 * tau))
    return float(((decay - 1.0) * rig.lat.x0_delayed[2] + gain * rig.lat.raw_prev) / dt)


def following_rate(rig: Rig) -> float:
    return float((rig.angle - rig.lat.measured) / rig.lat.prediction_dt)


@pytest.mark.parametrize(
    ("model", "rate"),
    [("kinematics", kinematic_rate), ("no delay", following_rate), ("dynamics", following_rate)],
)
def test_the_commanded_rate(model: str, rate: Callable[[Rig], float]) -> None:
    rig = on_path(line(60.0), input_delay=0.15, **MODELS[model])
    rig.steer(0.02)
    for y in (0.5, -4.0):  # the second one is clamped
        rig.place(5.0, y)
        rig.tick()
        assert rig.rate == pytest.approx(rate(rig), abs=1e-6)
    assert rig.trace.angle_limited


@pytest.mark.parametrize("y", [0.4, -0.4])
def test_off_the_path_the_wheels_turn_the_same_way_forward_and_backward(y: float) -> None:
    """To the left of it, to the right: speed enters twice, by the heading and by the offset."""
    backward = on_path(make_points(np.arange(60.0), v=-1.0, yaw=math.pi))
    backward.place(5.0, -y, math.pi, -1.0)
    forward = on_path(line(60.0))
    forward.place(5.0, y)
    for rig in (backward, forward):
        rig.tick()
    assert not backward.trace.is_forward_shift
    assert backward.trace.lateral_error == pytest.approx(forward.trace.lateral_error) == y
    assert math.copysign(1.0, forward.angle) == -math.copysign(1.0, y)
    assert backward.angle == pytest.approx(forward.angle, rel=1e-6)


def test_a_left_bend_driven_backward_turns_the_wheels_with_it() -> None:
    """The same arc, there and back: on it, the wheels stand at atan(L / R) both times."""
    arc = circle(30.0, 60.0, 0.5)
    back = arc[::-1].copy()
    back["v"] = -1.0
    wheels = math.atan(2.74 / 30.0)
    for points, vx, sign in ((arc, 1.0, 1), (back, -1.0, -1)):
        rig = on_path(points)
        at = points[60]
        rig.steer(wheels)
        rig.place(at.x, at.y, 2.0 * math.atan2(at.qz, at.qw), vx)
        trace = rig.tick()
        assert trace.is_forward_shift == (sign > 0)
        assert rig.lat.hk[0] == pytest.approx(sign / 30.0, rel=1e-4)
        assert rig.lat.u_ref[0] == pytest.approx(wheels, rel=1e-4)
        assert rig.angle == pytest.approx(wheels, abs=2e-3)


def test_every_model_has_its_name() -> None:
    assert [model.name.lower() for model in VehicleModel] == [
        "kinematics",
        "kinematics_no_delay",
        "dynamics",
    ]
