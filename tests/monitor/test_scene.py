# SPDX-License-Identifier: Apache-2.0
"""What the top view is given."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.messages.inputs import Odometry
from safety_island.messages.points import POINT
from safety_island.messages.wire import Time
from safety_island.monitor.scene import MOST_POINTS, heading, path_values, pose_values


def odometry(x: float, yaw: float) -> Odometry:
    half = (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
    return Odometry(Time(), "map", "base_link", x, 2.0, 0.0, *half, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("yaw", [-3.0, -1.0, 0.0, 0.5, 3.1])
def test_heading(yaw: float) -> None:
    assert heading(odometry(1.0, yaw)) == pytest.approx(yaw)


def test_pose_and_none_where_it_is_no_number() -> None:
    found = pose_values(7.0004, odometry(1.0, 0.5), math.nan)
    assert found == {"t": 7.0, "x": 1.0, "y": 2.0, "yaw": 0.5, "steering": None}
    assert pose_values(7.0, odometry(math.nan, 0.5), 0.1) is None


@pytest.mark.parametrize("count", [0, 1, 2, MOST_POINTS, 4096])
def test_a_path_keeps_its_ends_and_is_no_longer_than_a_screen_needs(count: int) -> None:
    points = np.zeros(count, POINT)
    points["x"] = np.arange(count)
    points["v"] = 3.0
    found = path_values(points)
    assert len(found["x"]) == len(found["y"]) == len(found["v"]) == min(count, MOST_POINTS)
    if count:
        assert (found["x"][0], found["x"][-1]) == (0.0, count - 1.0)


def test_a_point_that_is_no_number_is_left_out() -> None:
    points = np.zeros(3, POINT)
    points["y"] = [1.0, math.nan, 3.0]
    assert path_values(points) == {"x": [0.0, 0.0], "y": [1.0, 3.0], "v": [0.0, 0.0]}
