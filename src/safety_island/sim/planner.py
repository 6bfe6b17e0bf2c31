# SPDX-License-Identifier: Apache-2.0
"""The planner of the simulation: publishes a window of the course and handles its stops."""

from __future__ import annotations

import math

import numpy as np

from safety_island.kernel.records import Records
from safety_island.sim.courses import DWELL_S, LEAD_IN, Course, Leg
from safety_island.sim.projection import Place, locate
from safety_island.sim.shapes import SPACING

STANDSTILL = 0.01
"""Below this speed [m/s] the vehicle stands."""

NEAR_STOP = 2.0
"""The vehicle has stopped for the stop when it stands within this distance [m] of it."""


class Planner:
    """Follows the vehicle along a course; ``window`` is the trajectory to publish.

    The window reaches ``behind`` and ``ahead`` [m] of the vehicle and never beyond the next stop,
    where it ends with speed zero. After ``dwell`` [s] at a stop the next leg is published; with
    ``repeat`` the course begins again at its own end after the last one.
    """

    def __init__(
        self,
        course: Course,
        *,
        behind: float = LEAD_IN,
        ahead: float = 100.0,
        dwell: float = DWELL_S,
        repeat: bool = False,
    ) -> None:
        self.course, self.dwell, self.repeat = course, dwell, repeat
        self.lap = 0
        self.legs_done = 0
        self.stop_errors: list[float] = []  # of every stop made, positive beyond it [m]
        self._behind, self._ahead = round(behind / SPACING), round(ahead / SPACING)
        self._legs = course.legs
        self._number = 0
        self._stopped_at: float | None = None
        first = self.leg.points[self.leg.start]
        self.place = locate(self.leg, self.leg.start, float(first["x"]), float(first["y"]))

    @property
    def leg(self) -> Leg:
        """The leg that is being driven."""
        return self._legs[self._number]

    @property
    def stop_station(self) -> float:
        """Station [m] of the next stop."""
        return self.leg.origin + (len(self.leg.points) - 1) * SPACING

    @property
    def finished(self) -> bool:
        """Whether the vehicle stands at the last stop and no lap follows."""
        at_last = self._number == len(self._legs) - 1
        return at_last and self._stopped_at is not None and not self.repeat

    def start_pose(self) -> tuple[float, float, float]:
        """Position [m] and yaw [rad] where the course starts."""
        point = self._legs[0].points[self._legs[0].start]
        return float(point["x"]), float(point["y"]), _yaw(point)

    def update(self, now: float, x: float, y: float, speed: float) -> Place:
        """Take the vehicle's position [m] and speed [m/s] at ``now`` [s]; return its place."""
        self.place = locate(self.leg, self.place.segment, x, y)
        beyond = self.place.station - self.stop_station
        if self._stopped_at is None:
            if abs(speed) < STANDSTILL and abs(beyond) < NEAR_STOP:
                self._stopped_at = now
                self.legs_done += 1
                self.stop_errors.append(beyond)
        elif now - self._stopped_at >= self.dwell and not self.finished:
            self._next_leg()
            self.place = locate(self.leg, self.leg.start, x, y)
        return self.place

    def window(self) -> Records:
        """The trajectory: a view of the leg's points around the vehicle."""
        first = max(self.place.segment - self._behind, 0)
        return self.leg.points[first : self.place.segment + self._ahead]

    def _next_leg(self) -> None:
        self._stopped_at = None
        self._number += 1
        if self._number == len(self._legs):
            end = self._legs[-1].points[-1]
            self._legs = tuple(_move(leg, self.course.legs[0], end) for leg in self.course.legs)
            self._number = 0
            self.lap += 1


def _yaw(point: Records) -> float:
    return 2.0 * math.atan2(float(point["qz"]), float(point["qw"]))


def _move(leg: Leg, first: Leg, onto: Records) -> Leg:
    """Move a leg of a flat start so that the course starts at the point ``onto``."""
    origin = first.points[first.start]
    turn = _yaw(onto) - _yaw(origin)
    cosine, sine = math.cos(turn), math.sin(turn)
    points = leg.points.copy()
    dx, dy = points["x"] - origin["x"], points["y"] - origin["y"]
    points["x"] = onto["x"] + cosine * dx - sine * dy
    points["y"] = onto["y"] + sine * dx + cosine * dy
    points["z"] += onto["z"] - origin["z"]
    half = np.array([math.cos(0.5 * turn), math.sin(0.5 * turn)])
    for real, imaginary in (("qw", "qz"), ("qx", "qy")):
        a, b = points[real].copy(), points[imaginary].copy()
        points[real], points[imaginary] = half[0] * a - half[1] * b, half[0] * b + half[1] * a
    return Leg(points, leg.start, leg.origin)
