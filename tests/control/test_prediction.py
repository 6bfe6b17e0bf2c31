# SPDX-License-Identifier: Apache-2.0
"""The path over the horizon: velocity filter, times, length of a step, samples."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safety_island.kernel.records import Records
from tests.control.lateral_rig import Rig, Values, circle, line, make_points, on_path

EPSILON = np.finfo(float).eps
TAU, LIMIT = 0.3, 2.0


def filtered(rig: Rig) -> Values:
    """Speed after the velocity filter from the ego's segment on, written down step by step."""
    lat = rig.lat
    x, y, v = (lat[name][lat.segment : lat.ref_n + 1] for name in ("rx", "ry", "rv"))
    speed = rig.follower.inputs["vx"][0]
    out = [speed, speed]
    for i in range(2, len(v)):
        dt = math.hypot(x[i] - x[i - 1], y[i] - y[i - 1]) / max(abs(speed), EPSILON)
        a = TAU / (TAU + dt)
        wanted = a * speed + (1.0 - a) * v[i] - speed
        speed += min(max(wanted, -LIMIT * dt), LIMIT * dt)
        out.append(speed)
    return np.array([*out, 0.0])


def times(rig: Rig, speeds: Values) -> Values:
    """Times of the points, the last a hundred seconds after the closing duplicate."""
    lat = rig.lat
    part = slice(lat.segment, lat.ref_n + 1)
    steps = [np.diff(lat[name][part]) for name in ("rx", "ry", "rz")]
    length = np.sqrt(sum(step * step for step in steps))
    dt = np.maximum(length / np.maximum(np.abs(speeds[: len(length)]), 0.1), 1e-4)
    t = np.concatenate([[0.0], np.cumsum(dt)])
    return np.append(t, t[-1] + 100.0)


def wavy(rng: np.random.Generator, sign: float) -> Records:
    """A bent, climbing path of random speed that stops twice."""
    x = np.arange(0.0, 60.0, 0.7)
    v = np.where(np.abs(x - 25.0) < 2.0, 0.0, rng.uniform(0.0, 12.0, len(x)))
    points = make_points(x, np.sin(x / 9.0), sign * v)
    points["z"] = 0.3 * np.cos(x / 5.0)
    if sign < 0.0:
        points["qz"], points["qw"] = points["qw"].copy(), -points["qz"]
    return points


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("speed", [0.0, 1e-9, 0.02, 1.3, 9.0])
def test_speeds_and_times_are_the_filters_own(speed: float, sign: float) -> None:
    rig = on_path(wavy(np.random.default_rng(3), sign))
    rig.place(20.0, math.sin(20.0 / 9.0), 0.0 if sign > 0 else math.pi, vx=sign * speed)
    rig.tick()
    n = rig.lat.window
    speeds = filtered(rig)
    np.testing.assert_allclose(rig.lat.wv[:n], speeds[:n], rtol=0, atol=1e-12)
    np.testing.assert_allclose(rig.lat.wt[:n], times(rig, speeds)[:n], rtol=0, atol=1e-9)
    assert n > 30


def test_the_limit_of_acceleration_holds() -> None:
    """From 2 m/s toward 10 m/s: 0.1 m at 2 m/s takes 0.05 s, so 0.1 m/s more at first."""
    rig = on_path(line(60.0, v=10.0))
    rig.place(vx=2.0)
    rig.tick()
    np.testing.assert_allclose(rig.lat.wv[:3], [2.0, 2.0, 2.1], rtol=0, atol=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_speed_that_fades_away_leaves_its_own_sign_or_none(sign: float) -> None:
    """Below 1e-4 m/s the sign is all that the model sees of a speed, so no rounding may turn it."""
    x = np.arange(0.0, 30.0, 0.5)
    rig = on_path(make_points(x, v=np.where(x < 5.0, sign, 0.0), yaw=0.0 if sign > 0 else math.pi))
    for i in range(40):
        rig.place(4.0 + i * 0.01, 0.0, 0.0 if sign > 0 else math.pi, sign * (1.5 - i * 0.03))
        rig.tick()
        tail = sign * rig.lat.wv[: rig.lat.window]
        assert (tail >= 0.0).all()
        assert (tail == 0.0).any(), "it ends at zero, not at the smallest number"


def step_length(rig: Rig) -> Any:
    return rig.tick().prediction_dt


@pytest.mark.parametrize(
    ("speed", "seconds"),
    [
        (10.0, 0.1),  # 5 m take 0.5 s: the shortest step
        (1.25, 0.1),  # 5 m take 4 s
        (0.5, 10.0 / 49),
        (0.125, 40.0 / 49),
        (0.001, 50.0 / 49),  # times are counted with at least 0.1 m/s
    ],
)
def test_the_horizon_covers_five_metres(speed: float, seconds: float) -> None:
    rig = on_path(line(40.0, v=speed))
    rig.place(10.0, vx=speed)
    assert step_length(rig) == pytest.approx(seconds, rel=1e-9)


def test_the_length_counts_from_the_nearest_point_and_the_time_from_the_ego() -> None:
    """Between two points: the ego's own place is a reference point, so both are the same here."""
    rig = on_path(line(40.0, v=0.5), mpc_min_prediction_length=3.0)
    rig.place(10.03, vx=0.5)
    assert step_length(rig) == pytest.approx(6.0 / 49, rel=1e-9)


def test_the_end_of_the_path_ends_the_horizon() -> None:
    """3 m are left: 6 s at 0.5 m/s, with the speed kept to the end (the filter lags for 0.3 s)."""
    rig = on_path(line(10.0, v=0.5))
    rig.place(7.0, vx=0.5)
    rig.tick()
    last = times(rig, filtered(rig))[-2]
    assert rig.trace.prediction_dt == pytest.approx((last - rig.lat.nearest_time) / 49, rel=1e-12)
    assert last - rig.lat.nearest_time == pytest.approx(6.0, abs=0.3)


def test_the_delay_shortens_the_step_and_shifts_the_samples() -> None:
    """0.3 s of delay are two periods; at 0.5 m/s the 10 s to 5 m ahead lose as much."""
    rig = on_path(line(40.0, v=np.linspace(0.25, 1.25, 41)), input_delay=0.3)
    rig.place(10.0, vx=0.5)
    rig.tick()
    assert rig.lat.delay_n == 2
    n = rig.lat.window
    wt, wv = rig.lat.wt[:n], rig.lat.wv[:n]
    t = rig.lat.nearest_time + 0.3 + np.arange(50) * rig.lat.prediction_dt
    np.testing.assert_allclose(rig.lat.hv[:50], np.interp(t, wt, wv), rtol=0, atol=1e-12)
    ahead = np.interp(5.0, rig.lat.rx[rig.lat.segment :][:n] - 10.0, wt)
    assert rig.lat.prediction_dt == pytest.approx((ahead - t[0]) / 49, rel=1e-9)


def test_samples_beyond_the_end_stand_still_there() -> None:
    """The closing duplicate carries its zero speed for a hundred seconds."""
    rig = on_path(circle(30.0, 2.0))
    rig.place(float(rig.follower.points["x"][3]), float(rig.follower.points["y"][3]))
    rig.tick()
    n = rig.lat.window
    assert n == rig.lat.ref_n + 2 - rig.lat.segment
    assert rig.lat.wt[n - 1] - rig.lat.wt[n - 2] == pytest.approx(100.0)
    assert rig.lat.hv[49] == pytest.approx(rig.lat.wv[n - 2] * (1 - 4.4 / 100.0), rel=0.01)


def test_both_curvatures_are_read_with_their_own_reach() -> None:
    """A straight that turns into a circle: the longer reach sees the bend earlier."""
    straight, bend = np.arange(0.0, 10.0, 0.5), np.arange(0.0, 1.5, 0.05)
    x = np.concatenate([straight, 10.0 + 10.0 * np.sin(bend)])
    y = np.concatenate([0.0 * straight, 10.0 * (1.0 - np.cos(bend))])
    rig = on_path(make_points(x, y, 4.0), curvature_smoothing_num_ref_steer=35)
    rig.place(2.0, vx=4.0)
    rig.tick()
    near, far = np.array(rig.lat.hk[:50]), np.array(rig.lat.hks[:50])
    assert np.argmax(far > 1e-3) < np.argmax(near > 1e-3)
    assert near[-1] == pytest.approx(0.1, abs=1e-3) == far[-1]
    rig = on_path(make_points(x, y, 4.0))
    rig.place(2.0, vx=4.0)
    rig.tick()
    np.testing.assert_array_equal(rig.lat.hk[:50], rig.lat.hks[:50])
