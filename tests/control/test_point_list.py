# SPDX-License-Identifier: Apache-2.0
"""Copy, interpolation and insertion on lists of points."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.control.point_list import (
    copy_distinct,
    insert_point,
    interpolate_at,
    interpolate_pose,
)
from safety_island.control.records import POINT
from safety_island.kernel.records import Records


def points(xy: list[tuple[float, float]], yaw: list[float] | None = None) -> Records:
    """A list with room for two more points."""
    made: Records = np.zeros(len(xy) + 2, POINT)
    for i, (x, y) in enumerate(xy):
        made[i].x, made[i].y = x, y
        made[i].qz = math.sin(yaw[i] / 2) if yaw else 0.0
        made[i].qw = math.cos(yaw[i] / 2) if yaw else 1.0
    return made


def test_interpolation_projects_and_holds_the_ends() -> None:
    path = points([(0, 0), (2, 0)], [0.0, 1.0])
    path[1].z, path[0].v, path[1].v, path[1].acc = 4.0, 10.0, 20.0, -2.0
    out: Records = np.zeros(1, POINT)
    interpolate_at(path, 0, 0.5, 7.0, out[0])
    assert (out[0].x, out[0].y, out[0].z) == (0.5, 0.0, 1.0)
    assert (out[0].v, out[0].acc) == (12.5, -0.5)
    assert 2 * math.atan2(out[0].qz, out[0].qw) == pytest.approx(0.25, abs=1e-15)
    interpolate_at(path, 0, 9.0, 0.0, out[0])
    assert (out[0].x, out[0].v) == (2.0, 20.0)
    interpolate_at(path, 0, -9.0, 0.0, out[0])
    assert (out[0].x, out[0].v) == (0.0, 10.0)


def test_speeds_are_interpolated_in_double_and_rounded_once() -> None:
    path = points([(0, 0), (1, 0)])
    path[0].v, path[1].v = np.float32(0.1), np.float32(0.7)
    out: Records = np.zeros(1, POINT)
    interpolate_at(path, 0, 1.0 / 3.0, 0.0, out[0])
    exact = float(np.float32(0.1)) + (float(np.float32(0.7)) - float(np.float32(0.1))) / 3.0
    assert out[0].v == np.float32(exact)


def test_on_a_segment_without_length_the_first_point_is_taken() -> None:
    path = points([(1, 1), (1, 1)])
    path[0].v, path[1].v = 3.0, 9.0
    out: Records = np.zeros(1, POINT)
    interpolate_at(path, 0, 5.0, 5.0, out[0])
    assert (out[0].x, out[0].v) == (1.0, 3.0)


@pytest.mark.parametrize("ratio", [0.0, 0.25, 0.5, 1.0])
def test_the_orientation_takes_the_shorter_way(ratio: float) -> None:
    path = points([(0, 0), (1, 0)], [3.0, -3.0])
    path[1].qz, path[1].qw = -path[1].qz, -path[1].qw  # the same turn with the other sign
    out: Records = np.zeros(1, POINT)
    interpolate_pose(path[0], path[1], ratio, out[0])
    turned = 2 * math.atan2(out[0].qz, out[0].qw)
    expected = 3.0 + ratio * (2 * math.pi - 6.0)
    assert math.cos(turned - expected) == pytest.approx(1.0, abs=1e-15)


def test_the_same_orientation_with_the_other_sign_is_kept() -> None:
    path = points([(0, 0), (1, 0)], [1.0, 1.0])
    path[1].qz, path[1].qw = -path[1].qz, -path[1].qw
    out: Records = np.zeros(1, POINT)
    interpolate_pose(path[0], path[1], 0.5, out[0])
    assert (out[0].qz, out[0].qw) == pytest.approx((math.sin(0.5), math.cos(0.5)), abs=1e-15)


def test_insertion_does_not_look_beyond_the_list() -> None:
    path = points([(0, 0), (1, 0), (1, 0), (1, 0)])
    new: Records = np.zeros(1, POINT)
    new[0].x, new[0].v = 1.0, 5.0
    assert insert_point(path, 2, 1, new[0]) == 2
    assert list(path["v"][:2]) == [0.0, 5.0]


def test_copying_leaves_out_what_overlaps_the_point_before() -> None:
    path = points([(0, 0), (0, 9e-9), (1, 0), (1, 0), (1, 0), (2, 0)])
    out: Records = np.zeros(8, POINT)
    assert copy_distinct(path, 6, out) == 3
    assert list(out["x"][:3]) == [0.0, 1.0, 2.0]


@pytest.mark.parametrize(
    ("x", "expected"),
    [
        (0.5, [0.0, 0.5, 1.0, 1.0 + 6e-9, 2.0]),
        (0.0, [0.0, 1.0, 1.0 + 6e-9, 2.0]),  # on its predecessor: left out
        (1.0 - 6e-9, [0.0, 1.0 - 6e-9, 1.0 + 6e-9, 2.0]),  # covers one follower
        (1.0 + 3e-9, [0.0, 1.0 + 3e-9, 2.0]),  # covers two
    ],
)
def test_insertion_keeps_the_list_free_of_overlaps(x: float, expected: list[float]) -> None:
    path = points([(0, 0), (1, 0), (1 + 6e-9, 0), (2, 0)])
    new: Records = np.zeros(1, POINT)
    new[0].x = x
    count = insert_point(path, 4, 1, new[0])
    assert list(path["x"][:count]) == expected
