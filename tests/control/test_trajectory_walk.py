# SPDX-License-Identifier: Apache-2.0
"""Distances, stop points and pitch along lists of points."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.control.point_list import interpolate_pose
from safety_island.control.records import POINT
from safety_island.control.trajectory_walk import pitch_ahead, pose_ahead, stop_distance, stop_index
from safety_island.kernel.records import Records


def line(x: list[float], v: list[float], z: list[float] | None = None) -> Records:
    made: Records = np.zeros(len(x), POINT)
    made["x"], made["v"], made["qw"] = x, v, 1.0
    if z is not None:
        made["z"] = z
    return made


@pytest.mark.parametrize(
    ("v", "nearest", "distance"),
    [
        ([1, 1, 0, 1], 0, 2.0),  # to the stop point
        ([1, 1, 1, 1], 0, 3.0),  # to the last point
        ([1, 1, 0, 0], 3, -1.0),  # behind: negative
        ([0, 1, 1, 1], 2, -2.0),  # the first stop point counts, also behind
        ([1, 9.9e-4, 1, 1], 0, 1.0),
        ([1, 1.01e-3, 1, 1], 0, 3.0),
        ([-1, -1, -9.9e-4, -1], 0, 2.0),  # in reverse too
    ],
)
def test_the_stop_distance_is_signed(v: list[float], nearest: int, distance: float) -> None:
    assert stop_distance(line([0, 1, 2, 3], v), 4, nearest) == distance


def test_a_list_without_a_stop_point_says_so() -> None:
    assert stop_index(line([0, 1], [1, 1]), 2) == -1


def test_the_stop_distance_is_two_dimensional() -> None:
    assert stop_distance(line([0, 3], [1, 1], [0, 4]), 2, 0) == 3.0


@pytest.mark.parametrize(
    ("distance", "x", "z"), [(0.0, 0, 0), (2.5, 1.5, 2.0), (5.0, 3, 4), (6.0, 4, 4), (99.0, 5, 4)]
)
def test_the_walk_is_three_dimensional_and_ends_at_the_last_point(
    distance: float, x: float, z: float
) -> None:
    path = line([0, 3, 5], [1, 1, 1], [0, 4, 4])
    out: Records = np.zeros(1, POINT)
    pose_ahead(path, 3, 0, distance, out[0])
    assert (out[0].x, out[0].z) == pytest.approx((x, z), abs=1e-15)


def test_the_walk_turns_the_orientation_too() -> None:
    path = line([0, 1], [1, 1])
    path[1].qz, path[1].qw = math.sin(0.4), math.cos(0.4)
    out: Records = np.zeros(1, POINT)
    pose_ahead(path, 2, 0, 0.5, out[0])
    assert 2 * math.atan2(out[0].qz, out[0].qw) == pytest.approx(0.4, abs=1e-15)
    interpolate_pose(path[0], path[1], 1.0, out[0])
    assert 2 * math.atan2(out[0].qz, out[0].qw) == pytest.approx(0.8, abs=1e-15)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_pitch_reaches_to_the_first_point_beyond_a_wheelbase(side: float) -> None:
    path = line([0, 0.6, 1.2, 1.8], [1] * 4, [0, side * 0.8, side * 1.6, side * 1.6])
    up = math.atan2(side * 0.8, 0.6)
    assert pitch_ahead(path, 4, 0, 0.9) == pytest.approx(up, abs=1e-15)
    assert pitch_ahead(path, 4, 0, 1.9) == pytest.approx(up, abs=1e-15)
    whole = math.atan2(side * 1.6, 1.8)
    assert pitch_ahead(path, 4, 0, 2.05) == pytest.approx(whole, abs=1e-15)


def test_near_the_end_the_pitch_is_that_of_the_last_segment() -> None:
    path = line([0, 1, 2, 3], [1] * 4, [0, 0, 0, 1])
    assert pitch_ahead(path, 4, 3, 2.7) == pytest.approx(math.pi / 4, abs=1e-15)
    assert pitch_ahead(path, 4, 2, 2.7) == pytest.approx(math.pi / 4, abs=1e-15)
    assert pitch_ahead(path, 4, 1, 2.7) == pytest.approx(math.atan2(1, 2), abs=1e-15)
