# SPDX-License-Identifier: Apache-2.0
"""The loop on virtual time, first with a plain controller of its own."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.control.records import COMMAND
from safety_island.errors import ConfigurationError
from safety_island.kernel.records import Records
from safety_island.sim.closed_loop import ClosedLoop, drive
from safety_island.sim.courses import COURSES, load_course


class PurePursuit:
    """Steers at a point ahead and tracks the speed of the nearest: enough to try the loop."""

    def __init__(self) -> None:
        self.command: Records = np.zeros(1, COMMAND)
        self.log: list[tuple[str, float]] = []
        self._points: Records | None = None
        self._pose = (0.0, 0.0, 0.0)
        self._speed = self._slope = 0.0

    def offer_trajectory(self, points: Records, stamp: float) -> None:
        self.log.append(("trajectory", stamp))
        self._points = points

    def offer_odometry(self, *values: float) -> None:
        x, y, _, qx, qy, qz, qw, vx, _, _ = values
        self._pose = (x, y, 2.0 * math.atan2(qz, qw))
        self._slope = 2.0 * (qx * qz - qw * qy)
        self._speed = vx

    def offer_steering(self, angle: float) -> None: ...
    def offer_acceleration(self, ax: float) -> None: ...
    def offer_operation_mode(self, mode: int, enabled: bool) -> None: ...

    def step(self, now: float) -> None:
        self.log.append(("step", now))
        points = self._points
        assert points is not None
        x, y, yaw = self._pose
        distance = np.hypot(points["x"] - x, points["y"] - y)
        nearest = int(np.argmin(distance))
        reach = max(4.0, 1.0 * self._speed)
        beyond = np.flatnonzero(distance[nearest:] > reach)
        goal = points[nearest + int(beyond[0])] if len(beyond) else points[-1]
        bearing = math.atan2(float(goal["y"]) - y, float(goal["x"]) - x) - yaw
        curvature = 2.0 * math.sin(bearing) / max(reach, 1.0) if len(beyond) else 0.0
        target = float(points["v"][min(nearest + 2, len(points) - 1)])
        self.command["steering_tire_angle"] = math.atan(2.74 * curvature)
        wish = 1.5 * (target - self._speed) + float(points["acc"][nearest]) + 9.81 * self._slope
        arrived = nearest >= len(points) - 2 and self._speed < 0.5
        self.command["acceleration"] = -2.0 if arrived else wish


@pytest.mark.parametrize("name", sorted(COURSES))
def test_every_course_can_be_driven_to_its_end(name: str) -> None:
    result = drive(PurePursuit(), load_course(name), 0.05)
    assert result.finished
    assert result.metrics.reached_speed
    assert abs(result.rows[-1].lateral_error) < 1.0


def test_the_same_drive_gives_the_same_numbers() -> None:
    first, second = (drive(PurePursuit(), load_course("slalom"), 0.15, limit_s=20.0) for _ in "ab")
    assert first.rows == second.rows


@pytest.mark.parametrize(("period", "ticks"), [(0.15, 1), (0.03, 4), (0.05, 2)])
def test_plans_come_at_the_next_tick_after_a_tenth_of_a_second(period: float, ticks: int) -> None:
    follower = PurePursuit()
    drive(follower, load_course("straight"), period, limit_s=3.0)
    names = [name for name, _ in follower.log]
    gaps = np.diff(np.flatnonzero([name == "trajectory" for name in names]))
    assert set(gaps.tolist()) == {ticks + 1}


def test_refuses_a_period_off_the_grid() -> None:
    with pytest.raises(ConfigurationError, match=r"0\.0333 s cannot be simulated"):
        ClosedLoop(PurePursuit(), load_course("straight"), 0.0333)


def test_ends_at_its_limit() -> None:
    result = drive(PurePursuit(), load_course("straight"), 0.15, limit_s=3.0)
    assert (len(result.rows), result.finished) == (20, False)
