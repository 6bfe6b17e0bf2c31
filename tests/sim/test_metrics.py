# SPDX-License-Identifier: Apache-2.0
"""What counts for the verdict on a drive."""

from __future__ import annotations

from safety_island.sim.metrics import Metrics
from safety_island.sim.projection import Place


def _place(error: float, speed: float = 8.0) -> Place:
    return Place(0, 0.0, error, 0.0, 0.0, speed)


def test_the_first_seconds_do_not_count() -> None:
    metrics = Metrics()
    metrics.update(100.0, _place(0.8), 1.0)
    metrics.update(104.9, _place(-0.7), 1.0)
    assert (metrics.max_lateral_error, metrics.on_course) == (0.0, True)
    metrics.update(105.0, _place(-0.2), 1.0)
    metrics.update(106.0, _place(0.1), 1.0)
    assert (metrics.left_most, metrics.right_most) == (0.1, -0.2)
    assert (metrics.max_lateral_error, metrics.on_course) == (0.2, True)
    metrics.update(107.0, _place(0.3), 1.0)
    assert not metrics.on_course


def test_speed_counts_against_the_highest_target() -> None:
    metrics = Metrics()
    metrics.update(0.0, _place(0.0, 8.0), 7.5)
    assert not metrics.reached_speed
    metrics.update(1.0, _place(0.0, 2.0), 7.6)
    assert metrics.reached_speed


def test_nothing_driven_is_no_success() -> None:
    metrics = Metrics()
    assert not metrics.on_course
    assert not metrics.reached_speed
    assert not metrics.stopped_in_place


def test_every_stop_counts() -> None:
    assert Metrics(stop_errors=[0.5, -0.5]).stopped_in_place
    assert not Metrics(stop_errors=[0.1, 0.51]).stopped_in_place
