# SPDX-License-Identifier: Apache-2.0
"""Yaw, curvature and the ego's place on the reference path."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safety_island.control.lateral_state import new_lateral_state
from safety_island.control.reference_shape import (
    curvature_at,
    nearest_on_reference,
    segment_on_reference,
    yaw_at,
)
from tests.control.lateral_rig import Values
from tests.golden.harness import firmware

FAR = 1e6


def reference(x: Any, y: Any, forward: bool = True) -> Any:
    """A state whose reference path has these points, closed by its duplicate."""
    lat = new_lateral_state(firmware())[0]
    n = len(x)
    for name, values in (("rx", x), ("ry", y)):
        lat[name][:n] = values
        lat[name][n] = values[n - 1]
    lat.ref_n = n
    lat.ready = n + 1
    lat.is_forward = forward
    return lat


def round_trip(radius: float, n: int = 60) -> Any:
    angle = np.cumsum(np.random.default_rng(1).uniform(0.01, 0.04, n))
    return reference(abs(radius) * np.sin(angle), radius * (1.0 - np.cos(angle)))


def curvatures(lat: Any, reach: int) -> Values:
    return np.array([curvature_at(lat, i, reach) for i in range(lat.ref_n + 1)])


@pytest.mark.parametrize("radius", [30.0, -12.5])
@pytest.mark.parametrize("reach", [1, 15, 29, 1000])
def test_three_points_of_a_circle_give_its_curvature(radius: float, reach: int) -> None:
    """Whatever their distance; positive to the left; ends hold what their neighbours have."""
    found = curvatures(round_trip(radius), reach)
    np.testing.assert_allclose(found, 1.0 / radius, rtol=1e-10)


def test_a_straight_line_has_no_curvature() -> None:
    lat = reference(0.75 * np.arange(40.0), np.arange(40.0))
    np.testing.assert_array_equal(curvatures(lat, 15), 0.0)


def test_points_that_coincide_have_no_curvature() -> None:
    lat = reference([0.0, 1e-4, 2e-4], [0.0, 1e-4, 0.0])
    np.testing.assert_array_equal(curvatures(lat, 1), 0.0)


def test_the_curvature_looks_as_far_as_told_and_copies_the_ends() -> None:
    """A corner at index 10, seen over 3 points: only from 8 to 12."""
    lat = reference(np.minimum(np.arange(21.0), 10.0), np.maximum(np.arange(21.0) - 10.0, 0.0))
    found = curvatures(lat, 3)
    assert list(np.flatnonzero(found)) == [8, 9, 10, 11, 12]
    assert found[10] == pytest.approx(2.0 * 9.0 / (3.0 * 3.0 * math.sqrt(18.0)), rel=1e-12)
    widest = curvatures(lat, 10)
    assert widest[0] == widest[9] == widest[10] == widest[20] == widest[21] > 0.0


def test_yaw_is_the_direction_from_one_neighbour_to_the_other() -> None:
    lat = reference([0.0, 1.0, 2.0, 2.0], [0.0, 0.0, 1.0, 2.0])
    inner = [math.atan2(1, 2), math.atan2(2, 1)]
    assert [yaw_at(lat, i) for i in range(5)] == [inner[0], *inner, inner[1], inner[1]]


def test_yaw_in_reverse_is_half_a_turn_away() -> None:
    lat = reference([0.0, -1.0, -2.0], [0.0, 0.0, 0.0], forward=False)
    assert yaw_at(lat, 1) == 2.0 * math.pi


def test_a_path_of_two_points_has_the_yaw_of_the_received_points() -> None:
    lat = reference([0.0, 0.1], [0.0, 0.0])
    lat.short_yaw[:] = 0.25, 0.5
    assert [yaw_at(lat, i) for i in range(3)] == [0.25, 0.5, 0.5]


def loop() -> Any:
    """Out along the x axis, back 0.2 m beside it."""
    x = np.arange(0.0, 5.0, 0.5)
    return reference(np.concatenate([x, x[::-1]]), np.repeat([0.0, 0.2], 10))


@pytest.mark.parametrize(
    ("dist", "yaw", "found"),
    [
        (0.0, 0.0, 16),  # no limits: the nearest of all
        (3.0, 1.0, 3),  # facing outward
        (3.0, 0.05, 3),  # nobody faces so exactly: the distance alone, its first run
        (0.01, 1.0, 16),  # nobody is so near: the nearest of all
    ],
)
def test_nearest_with_soft_limits(dist: float, yaw: float, found: int) -> None:
    assert nearest_on_reference(loop(), 1.5, 0.15, 0.1, dist, yaw) == found


@pytest.mark.parametrize(
    ("x", "segment"), [(-1.0, 0), (0.4, 0), (1.0, 0), (1.1, 1), (2.4, 2), (2.6, 3), (7.0, 3)]
)
def test_the_ego_belongs_to_the_segment_that_holds_its_projection(x: float, segment: int) -> None:
    """Where the last point is the nearest, to the closing segment, which has no length."""
    lat = reference([0.0, 1.0, 2.0, 3.0], np.zeros(4))
    nearest = nearest_on_reference(lat, x, 0.2, 0.0, 0.0, 0.0)
    assert segment_on_reference(lat, nearest, x, 0.2) == segment
