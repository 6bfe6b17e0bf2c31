# SPDX-License-Identifier: Apache-2.0
"""Every course is a road that the vehicle and its controllers can follow."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.errors import ConfigurationError
from safety_island.sim.courses import COURSES, DEFAULT_COURSE, LEAD_IN, Course, Leg, load_course
from safety_island.sim.shapes import SPACING


def _yaw(leg: Leg) -> np.ndarray:
    points = leg.points
    forward_x = 1.0 - 2.0 * (points["qy"] ** 2 + points["qz"] ** 2)
    forward_y = 2.0 * (points["qw"] * points["qz"] + points["qx"] * points["qy"])
    return np.unwrap(np.arctan2(forward_y, forward_x))


@pytest.fixture(params=sorted(COURSES))
def course(request: pytest.FixtureRequest) -> Course:
    return load_course(request.param)


def test_the_issue_names_these_courses() -> None:
    assert {"s-curve", "lane-change", "u-turn", "stop-and-go", "slalom"} <= set(COURSES)
    assert DEFAULT_COURSE in COURSES


def test_an_unknown_course_is_answered_with_the_list() -> None:
    with pytest.raises(ConfigurationError, match=r"unknown course 's-curv'.*slalom"):
        load_course("s-curv")


def test_takes_about_a_minute(course: Course) -> None:
    assert 40.0 < course.duration < 60.0


def test_points_are_evenly_spaced(course: Course) -> None:
    for leg in course.legs:
        gaps = [np.diff(leg.points[axis]) for axis in ("x", "y", "z")]
        assert np.sqrt(sum(gap**2 for gap in gaps)) == pytest.approx(SPACING, abs=2e-3)


def test_headings_point_along_the_path(course: Course) -> None:
    for leg in course.legs:
        azimuth = np.unwrap(np.arctan2(np.diff(leg.points["y"]), np.diff(leg.points["x"])))
        yaw = _yaw(leg)
        assert np.abs(np.sin(azimuth - 0.5 * (yaw[:-1] + yaw[1:]))).max() < 2e-3


def test_quaternions_are_units_and_show_the_slope(course: Course) -> None:
    for leg in course.legs:
        p = leg.points
        norm = p["qx"] ** 2 + p["qy"] ** 2 + p["qz"] ** 2 + p["qw"] ** 2
        assert norm == pytest.approx(1.0)
        pitch = np.arcsin(2.0 * (p["qx"] * p["qz"] - p["qw"] * p["qy"]))
        rise = np.arctan2(np.diff(p["z"]), np.hypot(np.diff(p["x"]), np.diff(p["y"])))
        assert 0.5 * (pitch[:-1] + pitch[1:]) == pytest.approx(rise, abs=2e-3)


def test_bends_are_smooth_and_within_the_steering(course: Course) -> None:
    for leg in course.legs:
        angle = leg.points["front_wheel"].astype(float)
        assert np.abs(angle).max() < 0.5  # of 0.70 rad
        assert np.abs(np.diff(angle) * leg.points["v"][1:] / SPACING).max() < 0.35  # rad/s


def test_speeds_keep_the_limits(course: Course) -> None:
    for leg in course.legs:
        v = leg.points["v"].astype(float)
        along = np.diff(v**2) / (2.0 * SPACING)
        assert along.min() >= -1.0
        assert along.max() <= 1.0 + 1e-4  # speeds are float32
        assert along == pytest.approx(leg.points["acc"][:-1].astype(float), abs=1e-4)
        assert np.abs(v * leg.points["heading_rate"]).max() < 2.0
        assert (v[:-1] > 0.0).all()
        assert v[-1] == 0.0


def test_legs_follow_one_another(course: Course) -> None:
    lead = round(LEAD_IN / SPACING)
    for before, after in zip(course.legs, course.legs[1:], strict=False):
        for axis in ("x", "y", "z", "qz"):
            overlap = before.points[axis][-lead - 1 :]
            assert overlap == pytest.approx(after.points[axis][: lead + 1])
        assert after.origin == before.origin + (len(before.points) - 1 - lead) * SPACING


def test_begins_and_ends_on_a_straight(course: Course) -> None:
    count = round(LEAD_IN / SPACING)
    assert np.abs(course.legs[0].points["front_wheel"][:count]).max() == 0.0
    assert np.abs(course.legs[-1].points["front_wheel"][-count:]).max() == 0.0


def test_lane_change_is_exactly_a_lane() -> None:
    y = load_course("lane-change").legs[0].points["y"]
    assert y[round(130.0 / SPACING) + round(LEAD_IN / SPACING)] == pytest.approx(3.5, abs=1e-4)


def test_u_turn_ends_where_it_looks_back() -> None:
    leg = load_course("u-turn").legs[-1]
    assert math.cos(_yaw(leg)[-1]) == pytest.approx(-1.0)


def test_hill_climbs_eight_percent() -> None:
    z = load_course("hill").legs[0].points["z"]
    assert np.diff(z).max() / SPACING == pytest.approx(math.sin(math.atan(0.08)), rel=1e-3)
