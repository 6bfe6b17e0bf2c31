# SPDX-License-Identifier: Apache-2.0
"""A path of the user's own becomes a course, or an error in one line."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from safety_island.errors import ConfigurationError
from safety_island.sim.closed_loop import drive
from safety_island.sim.courses import LEAD_IN, load_course
from safety_island.sim.own_path import DEFAULT_SPEED, make_course, read_course
from safety_island.sim.shapes import SPACING

TURN = np.linspace(0.0, np.pi, 12)
X, Y = 30.0 * np.sin(TURN), 30.0 * (1.0 - np.cos(TURN))


def test_a_half_circle_of_few_points_becomes_a_smooth_path_that_ends_at_its_last_point() -> None:
    (leg,) = make_course(X, Y, TURN, 4.0).legs
    points = leg.points[leg.start :]
    radius = np.hypot(points["x"], points["y"] - 30.0)
    assert np.abs(radius - 30.0).max() < 0.05
    assert np.allclose(np.hypot(np.diff(points["x"]), np.diff(points["y"])), SPACING, atol=1e-3)
    assert (points["x"][-1], points["y"][-1]) == pytest.approx((0.0, 60.0), abs=1e-6)
    assert np.hypot(points["x"][0], points["y"][0]) < SPACING
    assert leg.start == round(LEAD_IN / SPACING)
    assert leg.points["x"][0] < -LEAD_IN + SPACING + 1e-6


def test_the_direction_is_that_of_the_points_where_there_is_no_yaw() -> None:
    (leg,) = make_course(X, Y, v=4.0).legs
    radius = np.hypot(leg.points["x"], leg.points["y"] - 30.0)[leg.start :]
    assert np.abs(radius - 30.0).max() < 0.5


def test_the_speed_is_the_highest_and_bends_and_stops_are_slower() -> None:
    course = make_course(X, Y, TURN, 20.0)
    speed = course.legs[0].points["v"]
    assert speed.max() == pytest.approx(np.sqrt(1.5 * 30.0), rel=0.03)
    assert speed[-1] == 0.0
    assert make_course([0.0, 90.0], [0.0, 0.0]).top_speed == DEFAULT_SPEED


def test_a_speed_for_each_point() -> None:
    x = np.arange(0.0, 201.0, 10.0)
    course = make_course(x, np.zeros_like(x), v=np.where(x < 100.0, 3.0, 6.0))
    points = course.legs[0].points
    assert points["v"][points["x"] < 90.0].max() == pytest.approx(3.0)
    assert course.top_speed == pytest.approx(6.0)


def test_speed_zero_in_between_is_a_stop() -> None:
    x = np.arange(0.0, 101.0, 5.0)
    course = make_course(x, np.zeros_like(x), v=np.where((x > 45.0) & (x < 60.0), 0.0, 5.0))
    first, second = course.legs
    assert first.points["x"][-1] == pytest.approx(50.0, abs=SPACING)
    assert second.points["x"][-1] == pytest.approx(100.0)
    assert first.points["v"][-1] == second.points["v"][-1] == 0.0


def test_points_on_top_of_each_other_are_one() -> None:
    twice = make_course(np.repeat(X, 2), np.repeat(Y, 2), np.repeat(TURN, 2), 4.0)
    assert np.array_equal(twice.legs[0].points, make_course(X, Y, TURN, 4.0).legs[0].points)


def test_a_shipped_course_given_as_points_is_driven_as_well(follower: Any) -> None:
    points = load_course("s-curve").legs[0].points[20:]
    done = drive(follower, make_course(points["x"], points["y"], v=8.0), 0.15)
    assert done.finished
    assert done.metrics.on_course and done.metrics.stopped_in_place


@pytest.fixture
def follower() -> Any:
    from safety_island.control.follower import TrajectoryFollower
    from safety_island.params import load_set

    return TrajectoryFollower(load_set("default"))


@pytest.mark.parametrize(
    ("columns", "text"),
    [
        (([0.0, 1.0], [0.0, 0.0]), "1.00 m long, expected 5 to 50000 m"),
        (([], []), "x has 0 values, expected two points"),
        (([0.0, 1e6], [0.0, 0.0]), "1000000.00 m long"),
        (([0.0, 9.0, 3.0], [0.0, 0.0, 0.0]), "turns back at point 1"),
        (([0.0, np.nan], [0.0, 0.0]), "x of point 1 is nan"),
        (([0.0, 9.0], [0.0, 1e9]), r"y of point 1 is 1e\+09"),
        (([0.0, 9.0], [0.0]), "y has 1 values, and x has 2"),
        (([0.0, 9.0], [0.0, 0.0], [90.0, 90.0]), "yaw is in radians"),
        (([0.0, 9.0], [0.0, 0.0], None, -1.0), "reversing is not supported"),
        (([0.0, 9.0], [0.0, 0.0], None, 0.0), "nothing would drive"),
        (([0.0, 9.0], [0.0, 0.0], None, 1e3), "v of point 0 is 1000, expected at most 60"),
        (([0.0, 9.0], ["a", "b"]), "y is not a list of numbers"),
        ((5.0, 6.0), "x has 1 values, expected two points"),
    ],
)
def test_what_is_no_path_is_one_line(columns: Any, text: str) -> None:
    with pytest.raises(ConfigurationError, match=text) as found:
        make_course(*columns)
    assert "\n" not in str(found.value)


CSV = "x,y,yaw,v\n0,0,0,3\n# a remark\n\n20,0,0,4\n"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.csv", CSV),
        ("a.csv", "\ufeff" + CSV.replace("\n", "\r\n")),
        ("a.csv", "v, x, yaw, y\n3, 0, 0, 0\n4, 20, 0, 0\n"),
        ("a.txt", "0,0,0,3\n20,0,0,4\n"),
        ("a.yaml", "x: [0, 20]\ny: [0, 0]\nyaw: [0, 0]\nv: [3, 4]\n"),
    ],
)
def test_a_file(tmp_path: Path, name: str, text: str) -> None:
    (tmp_path / name).write_text(text, "utf-8")
    course = read_course(tmp_path / name)
    expected = make_course([0.0, 20.0], [0.0, 0.0], [0.0, 0.0], [3.0, 4.0])
    assert np.array_equal(course.legs[0].points, expected.legs[0].points)


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("a.csv", "", "no column x"),
        ("a.csv", "x,z\n0,0\n", "unknown column 'z', expected x, y, yaw, v"),
        ("a.csv", "x,x\n0,0\n", "a column twice"),
        ("a.csv", "x,y\n0,0\n9\n", r"a.csv:3: 1 values, expected 2 \(x, y\)"),
        ("a.csv", "x,y\n0,0\n9,b\n", "a.csv:3: 'b' is not a number"),
        ("a.csv", "1,2,3,4,5\n", "5 values, expected 4"),
        ("a.yaml", "x: [", "no YAML"),
        ("a.yaml", "- 1\n", "a list of numbers for each"),
        ("a.yaml", "x: [0, 9]\nspeed: 3\n", "unknown key 'speed'"),
        ("a.yaml", "x: [0, 9]\ny: {a: 1}\n", "y is not a list of numbers"),
    ],
)
def test_a_file_that_is_no_path_is_one_line(
    tmp_path: Path, name: str, text: str, told: str
) -> None:
    (tmp_path / name).write_text(text, "utf-8")
    with pytest.raises(ConfigurationError, match=told) as found:
        read_course(tmp_path / name)
    assert "\n" not in str(found.value)
    with pytest.raises(ConfigurationError, match="cannot be read"):
        read_course(tmp_path / "none.csv")
