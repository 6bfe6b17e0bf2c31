# SPDX-License-Identifier: Apache-2.0
"""The real trajectory follower on every course, at the period of the island and at Autoware's."""

from __future__ import annotations

import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.params import load_set, with_period
from safety_island.sim.closed_loop import drive
from safety_island.sim.courses import COURSES, load_course


@pytest.mark.parametrize("period", [0.15, 0.03])
@pytest.mark.parametrize("name", sorted(COURSES))
def test_drives_the_course(name: str, period: float) -> None:
    course = load_course(name)
    parameters = with_period(load_set("default"), period)
    result = drive(TrajectoryFollower(parameters), course, period)
    assert result.finished
    assert result.metrics.on_course, f"{result.metrics.max_lateral_error:.3f} m off"
    assert result.metrics.reached_speed
    assert result.metrics.stopped_in_place
    assert len(result.metrics.stop_errors) == len(course.legs)
