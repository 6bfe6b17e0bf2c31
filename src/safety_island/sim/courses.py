# SPDX-License-Identifier: Apache-2.0
"""The courses that the simulated vehicle can drive: paths, speeds and stops.

A course is driven in legs. Each leg ends in a stop; its points begin some way behind the place
where it starts, so that a controller finds path behind the vehicle as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from safety_island.control.records import POINT
from safety_island.errors import ConfigurationError
from safety_island.kernel.records import Records
from safety_island.sim.course_designs import DESIGNS
from safety_island.sim.shapes import SPACING, Floats, Path, join, straight
from safety_island.sim.speed_profile import (
    SpeedLimits,
    accelerations,
    speed_profile,
    travel_time,
)

WHEELBASE = 2.74
"""[m], for the wheel angles in the points."""

LEAD_IN = 10.0
"""Path behind the first place of a course [m]; every course also ends in that much straight."""

DWELL_S = 2.0
"""How long the vehicle stands at a stop that is not the last [s]."""


@dataclass(frozen=True)
class Leg:
    """Points of one leg; driving starts at index ``start``, the stop is the last point."""

    points: Records
    start: int
    origin: float
    """Station [m] of the first point: negative in the lead-in, 0 where the course starts."""

    @cached_property
    def columns(self) -> tuple[list[float], list[float], list[float], list[float]]:
        """x, y, z [m] and speed [m/s] as plain numbers: a record's field costs a microsecond."""
        x, y, z, speed = (self.points[name].tolist() for name in ("x", "y", "z", "v"))
        return x, y, z, speed


@dataclass(frozen=True)
class Course:
    """A named course of one or more legs."""

    name: str
    summary: str
    legs: tuple[Leg, ...]

    @property
    def length(self) -> float:
        """Distance [m] from the start to the last stop."""
        last = self.legs[-1]
        return last.origin + (len(last.points) - 1) * SPACING

    @property
    def top_speed(self) -> float:
        """Highest speed [m/s] of the profile."""
        return max(float(leg.points["v"].max()) for leg in self.legs)

    @property
    def duration(self) -> float:
        """Time [s] to drive the course exactly at its speeds, stops included."""
        driving = sum(travel_time(leg.points["v"][leg.start :].astype(float)) for leg in self.legs)
        return driving + DWELL_S * (len(self.legs) - 1)


COURSES: dict[str, str] = {name: design.summary for name, design in DESIGNS.items()}
"""Name and one line about every course."""

DEFAULT_COURSE = "s-curve"


def make_points(path: Path, speed: Floats, first: int, last: int) -> Records:
    """Trajectory points of the path from index ``first`` to ``last``, both included."""
    part = slice(first, last + 1)
    points = np.zeros(last + 1 - first, POINT)
    pitch = np.arctan(path.grade[part])
    half_yaw, half_pitch = 0.5 * path.yaw[part], 0.5 * pitch
    points["x"], points["y"], points["z"] = path.x[part], path.y[part], path.z[part]
    points["qx"] = np.sin(half_yaw) * np.sin(half_pitch)
    points["qy"] = -np.cos(half_yaw) * np.sin(half_pitch)
    points["qz"] = np.sin(half_yaw) * np.cos(half_pitch)
    points["qw"] = np.cos(half_yaw) * np.cos(half_pitch)
    points["v"], points["acc"] = speed, accelerations(speed)
    points["heading_rate"] = speed * path.curvature[part]
    points["front_wheel"] = np.arctan(WHEELBASE * path.curvature[part])
    return points


def make_legs(path: Path, stops: Sequence[float], cruise: Floats) -> tuple[Leg, ...]:
    """Cut a path at its stops [m], counted from the end of the lead-in; its end is one as well.

    ``cruise`` is the highest speed [m/s] at each point of the path.
    """
    lead = round(LEAD_IN / SPACING)
    ends = [lead + round(stop / SPACING) for stop in stops] + [len(path.x) - 1]
    legs, start = [], lead
    for end in ends:
        first = start - lead
        part = slice(first, end + 1)
        speed = speed_profile(path.curvature[part], lead, SpeedLimits(cruise[part]))
        points = make_points(path, speed, first, end)
        legs.append(Leg(points, lead, (first - lead) * SPACING))
        start = end
    return tuple(legs)


@cache
def load_course(name: str) -> Course:
    """Return the course of that name. Raises ConfigurationError for an unknown one."""
    design = DESIGNS.get(name)
    if design is None:
        raise ConfigurationError(f"unknown course '{name}'; there are: {', '.join(COURSES)}")
    path = join((straight(LEAD_IN), *design.pieces()))
    legs = make_legs(path, design.stops, np.full(len(path.x), design.cruise))
    return Course(name, design.summary, legs)
