# SPDX-License-Identifier: Apache-2.0
"""The nearest search and projections."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.control.points import nearest_index, offset_along, segment_of
from safety_island.control.records import POINT
from safety_island.kernel.records import Records

FAR = 1e6


def points(xy: list[tuple[float, float]], yaw: list[float] | None = None) -> Records:
    """A list with room for two more points."""
    made: Records = np.zeros(len(xy) + 2, POINT)
    for i, (x, y) in enumerate(xy):
        made[i].x, made[i].y = x, y
        made[i].qz = math.sin(yaw[i] / 2) if yaw else 0.0
        made[i].qw = math.cos(yaw[i] / 2) if yaw else 1.0
    return made


def test_the_global_nearest_is_the_first_of_equals() -> None:
    path = points([(0, 0), (1, 0), (3, 0)])
    assert nearest_index(path, 3, 0.5, 0.0, 0.0, 0.0, 0.0) == 0
    assert nearest_index(path, 3, 2.0, 5.0, 0.0, 0.0, 0.0) == 1
    assert nearest_index(path, 3, 9.0, 0.0, 0.0, 0.0, 0.0) == 2


def test_only_the_first_run_inside_the_limits_counts() -> None:
    there_and_back = points([(0, 0.5), (1, 0.5), (9, 0.5), (1, 0.1), (0, 0.1)])
    assert nearest_index(there_and_back, 5, 0.9, 0.0, 0.0, 2.0, 3.0) == 1
    assert nearest_index(there_and_back, 5, 0.9, 0.0, 0.0, 0.0, 0.0) == 3


def test_the_first_run_may_be_the_first_point_alone() -> None:
    path = points([(0, 0.5), (9, 0), (0, 0.1)])
    assert nearest_index(path, 3, 0.0, 0.0, 0.0, 2.0, 3.0) == 0


def test_a_point_that_faces_elsewhere_is_skipped_while_another_fits() -> None:
    crossing = points([(1, 0), (0, 0), (0, 1)], [1.5, 1.5, 0.2])
    assert nearest_index(crossing, 3, 0.0, 0.1, 0.0, 3.0, 1.0) == 2
    assert nearest_index(crossing, 3, 0.0, 0.1, 0.0, 3.0, 0.1) == 1, "then the distance alone"
    assert nearest_index(crossing, 3, 0.0, 9.0, 0.0, 3.0, 1.0) == 2, "then the global nearest"


def test_the_yaw_limit_holds_across_the_wrap() -> None:
    path = points([(0, 0), (0, 0.5)], [0.0, math.pi - 0.05])
    assert nearest_index(path, 2, 0.0, 0.0, -math.pi + 0.05, 3.0, 0.2) == 1


@pytest.mark.parametrize(
    ("x", "segment"), [(-5.0, 0), (0.4, 0), (0.9, 0), (1.0, 0), (1.2, 1), (2.1, 1), (7.0, 1)]
)
def test_a_point_belongs_to_the_segment_that_holds_its_projection(x: float, segment: int) -> None:
    path = points([(0, 0), (1, 0), (2, 0)])
    nearest = nearest_index(path, 3, x, 0.3, 0.0, FAR, FAR)
    assert segment_of(path, 3, nearest, x, 0.3) == segment


def test_the_offset_is_signed_and_zero_where_the_segment_has_no_length() -> None:
    path = points([(0, 0), (3, 4), (3, 4)])
    assert offset_along(path, 0, 3.0, 4.0) == 5.0
    assert offset_along(path, 0, -3.0, -4.0) == -5.0
    assert offset_along(path, 0, -4.0, 3.0) == 0.0
    assert offset_along(path, 1, 9.0, 9.0) == 0.0
    assert offset_along(points([(1, 2), (4, 6)]), 0, 4.0, 6.0) == 5.0
