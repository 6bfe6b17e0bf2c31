# SPDX-License-Identifier: Apache-2.0
"""The reference path: where its points stand, what they hold, when the old one stays."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.control.limits import EXTENSION_POINTS, MAX_REFERENCE
from safety_island.control.status import MpcStatus
from safety_island.kernel.records import Records
from tests.control.lateral_rig import (
    Values,
    arc_of,
    circle,
    column,
    line,
    make_points,
    on_path,
    stations,
)

STEP = 0.1


def test_the_points_are_anchored_at_the_ego() -> None:
    rig = on_path(line(20.0))
    rig.place(3.14)
    rig.tick()
    s = stations(rig)
    assert s[rig.lat.anchor] == 3.14
    np.testing.assert_allclose(np.diff(s), STEP, rtol=0, atol=1e-12)
    assert s[0] == pytest.approx(0.04), "31 steps back; the first received point is not met"
    assert s[-1] == pytest.approx(19.94), "nor is the last"
    np.testing.assert_allclose(column(rig, "rx"), s, rtol=0, atol=1e-12)


def test_the_ego_before_the_path_sees_it_from_its_first_point() -> None:
    rig = on_path(line(4.95, 0.45))
    rig.place(-2.0)
    rig.tick()
    assert rig.lat.anchor == 0
    np.testing.assert_allclose(stations(rig), np.arange(50) * STEP, rtol=0, atol=1e-12)


def test_the_ego_beyond_the_path_sees_it_up_to_a_micrometre() -> None:
    rig = on_path(line(5.0))
    rig.place(5.4)
    rig.tick()
    s = stations(rig)
    assert s[-1] == 5.0 - 1e-6 and rig.lat.anchor == len(s) - 1
    assert len(s) == 50


def test_speed_is_linear_between_the_received_points_and_zero_at_the_end() -> None:
    rig = on_path(make_points([0.0, 1.0, 3.0, 5.0], v=[1.0, 2.0, 4.0, 3.0]))
    rig.tick()
    s, v = stations(rig), column(rig, "rv")
    np.testing.assert_allclose(v[:-1], np.interp(s, [0, 1, 3, 5], [1, 2, 4, 3])[:-1], atol=1e-12)
    assert v[-1] == 0.0
    n = rig.lat.ref_n
    closing = [rig.lat[name][n] - rig.lat[name][n - 1] for name in ("rx", "ry", "rz", "rv")]
    assert closing == [0.0, 0.0, 0.0, 0.0]


def natural_spline(arc: Values, values: Values, s: Values) -> Values:
    """Natural cubic spline, from the textbook: continuous first derivatives, ends not bent."""
    h = np.diff(arc)
    n = len(arc)
    system, right = np.eye(n), np.zeros(n)
    for i in range(1, n - 1):
        system[i, i - 1 : i + 2] = h[i - 1], 2 * (h[i - 1] + h[i]), h[i]
        right[i] = 6 * ((values[i + 1] - values[i]) / h[i] - (values[i] - values[i - 1]) / h[i - 1])
    second = np.linalg.solve(system, right)
    k = np.clip(np.searchsorted(arc, s) - 1, 0, n - 2)
    left, rest = s - arc[k], arc[k + 1] - s
    return np.asarray(
        (second[k] * rest**3 + second[k + 1] * left**3) / (6 * h[k])
        + (values[k] / h[k] - second[k] * h[k] / 6) * rest
        + (values[k + 1] / h[k] - second[k + 1] * h[k] / 6) * left
    )


@pytest.mark.parametrize("seed", range(3))
def test_positions_lie_on_the_natural_cubic_splines_over_the_plane_arc_length(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = make_points(
        np.cumsum(rng.uniform(0.05, 2.0, 60)), np.cumsum(rng.normal(0, 0.3, 60)), yaw=0.0
    )
    points["z"] = np.cumsum(rng.normal(0, 0.2, 60))
    rig = on_path(points)
    rig.place(*(float(points[name][20]) + 0.3 for name in ("x", "y")))
    rig.tick()
    for ours, received in (("rx", "x"), ("ry", "y"), ("rz", "z")):
        expected = natural_spline(arc_of(points), points[received], stations(rig))
        np.testing.assert_allclose(column(rig, ours), expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize(
    ("heading", "forward"), [(0.0, True), (1.57, True), (-1.57, True), (1.58, False), (3.1, False)]
)
def test_the_driving_direction_is_the_heading_against_the_first_step(
    heading: float, forward: bool
) -> None:
    """More than a quarter turn is reverse."""
    rig = on_path(make_points(np.arange(20.0), yaw=heading))
    assert rig.tick().is_forward_shift == forward or rig.status is not MpcStatus.SOLVED
    assert rig.lat.is_forward == forward


def test_a_path_of_one_reference_point_keeps_the_direction() -> None:
    rig = on_path(make_points(np.arange(20.0), yaw=math.pi))
    rig.place(yaw=math.pi)
    rig.tick()
    assert not rig.lat.is_forward
    rig.path(make_points([0.0, 0.02, 0.04], yaw=0.0))
    rig.tick()
    assert rig.lat.ref_n == 1 and not rig.lat.is_forward


def test_a_path_without_length_leaves_the_old_reference() -> None:
    tiny = make_points([0.0, 1e-7, 2e-7], yaw=0.0)
    rig = on_path(tiny)
    rig.tick()
    assert rig.trace.mpc_status == MpcStatus.NO_REFERENCE, "nor is there a first one"
    rig.path(line(5.0))
    rig.tick()
    before = column(rig, "rx")
    rig.path(tiny)
    rig.tick()
    assert rig.status is MpcStatus.SOLVED
    np.testing.assert_array_equal(column(rig, "rx"), before)


def test_two_points_leave_the_old_reference() -> None:
    rig = on_path(circle(30.0, 20.0))
    rig.tick()
    before = column(rig, "rx"), column(rig, "ry")
    rig.path(make_points([100.0, 101.0]))
    trace = rig.tick()
    assert rig.status is MpcStatus.SOLVED
    np.testing.assert_array_equal((column(rig, "rx"), column(rig, "ry")), before)
    assert trace.shape_changed, "the path in force ends elsewhere"


def crossing() -> Records:
    """There along the x axis, and back 0.2 m beside it."""
    x = np.arange(0.0, 21.0)
    return make_points(
        np.concatenate([x, x[::-1]]),
        np.repeat([0.0, 0.2], 21),
        yaw=np.repeat([0.0, math.pi], 21),
    )


def test_the_thresholds_keep_the_ego_on_its_own_branch() -> None:
    """Nearer to the way back, but it faces the other way."""
    for limits, anchor in (({}, 35.0), ({"ego_nearest_yaw_threshold": 1.0}, 5.0)):
        rig = on_path(crossing(), ego_nearest_dist_threshold=3.0 if limits else 0.0, **limits)
        rig.place(5.0, 0.15)
        rig.tick()
        assert stations(rig)[rig.lat.anchor] == pytest.approx(anchor, abs=0.3), limits


def test_the_longest_path_that_is_accepted_fits() -> None:
    length = (MAX_REFERENCE - EXTENSION_POINTS) * STEP
    rig = on_path(make_points(np.linspace(0.0, length - 1e-6, 4096)))
    for x in (0.0, 700.05, length):
        rig.place(x)
        rig.tick()
        assert rig.status is MpcStatus.SOLVED
        assert abs(rig.lat.ref_n - length / STEP) <= 1
