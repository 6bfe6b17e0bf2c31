# SPDX-License-Identifier: Apache-2.0
"""A course is repeated or cut so that it lasts as long as wanted."""

from __future__ import annotations

import numpy as np
import pytest

from safety_island.sim.courses import COURSES, load_course
from safety_island.sim.fit import OVERHEAD_S, SHORTEST, fit
from safety_island.sim.shapes import SPACING
from safety_island.sim.speed_profile import SpeedLimits
from safety_island.sim.world import World


@pytest.mark.parametrize("name", COURSES)
@pytest.mark.parametrize("time_s", [15.0, 20.0, 30.0, 45.0])
def test_cut_course_takes_the_time_and_ends_in_a_stop(name: str, time_s: float) -> None:
    whole = load_course(name)
    course, laps = fit(whole, time_s)
    assert laps == 1
    assert time_s - OVERHEAD_S - 3.5 < course.duration <= time_s - OVERHEAD_S
    assert SHORTEST <= course.length < whole.length
    assert course.legs[-1].points["v"][-1] == 0.0


@pytest.mark.parametrize("name", COURSES)
def test_cut_course_is_the_same_road_at_speeds_that_can_be_driven(name: str) -> None:
    whole = load_course(name)
    course, _ = fit(whole, 25.0)
    limits = SpeedLimits(whole.top_speed)
    for leg, same in zip(course.legs, whole.legs, strict=False):
        points = leg.points
        for column in ("x", "y", "z", "qz", "qw", "front_wheel"):
            assert np.array_equal(points[column], same.points[column][: len(points)])
        assert np.all(points["v"] <= same.points["v"][: len(points)] + 1e-3)
        gain = np.diff(points["v"][leg.start :].astype(float) ** 2) / (2.0 * SPACING)
        assert np.all(gain >= -limits.deceleration - 1e-3)


def test_whole_laps_when_there_is_time() -> None:
    course = load_course("s-curve")
    assert fit(course, 60.0) == (course, 1)
    assert fit(course, 2.0 * course.duration) == (course, 1)
    assert fit(course, 2.0 * course.duration + 10.0) == (course, 2)
    assert fit(course, 10.0 * course.duration + 40.0) == (course, 10)


def test_hardly_any_time_still_drives_a_little() -> None:
    course, laps = fit(load_course("s-curve"), 1.0)
    assert course.length == pytest.approx(SHORTEST)
    assert laps == 1


def test_world_ends_its_repetition_in_the_last_lap() -> None:
    world = World(load_course("straight"), 0.0, laps=2)
    world.advance(1.0)
    assert world.planner.repeat
    world.planner.lap = 1
    world.advance(2.0)
    assert not world.planner.repeat
