# SPDX-License-Identifier: Apache-2.0
"""Makes a course last about as long as is wanted: several laps, or an earlier stop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from safety_island.sim.courses import DWELL_S, WHEELBASE, Course, Leg
from safety_island.sim.shapes import SPACING
from safety_island.sim.speed_profile import SpeedLimits, accelerations, speed_profile

OVERHEAD_S = 3.0
"""What a drive takes beyond the course's own speeds: engaging, and the last decimetres."""

SHORTEST = 10.0
"""Distance [m] that is driven in any case."""


def fit(course: Course, time_s: float) -> tuple[Course, int]:
    """Return a course and a number of laps that take about ``time_s`` [s].

    Whole laps as far as they go, at least one; a course too long for one is cut where its time is
    up, with a stop there.
    """
    available = time_s - OVERHEAD_S
    laps = int((available + DWELL_S) // (course.duration + DWELL_S))
    if laps:
        return course, laps
    first, last = _index(course, SHORTEST), _index(course, course.length)
    while first < last:  # the last index at which the course is short enough
        middle = (first + last + 1) // 2
        if _cut(course, middle).duration <= available:
            first = middle
        else:
            last = middle - 1
    return _cut(course, first), 1


def _index(course: Course, station: float) -> int:
    return round((station - course.legs[0].origin) / SPACING)


def _cut(course: Course, index: int) -> Course:
    """The course up to a point, counted from the first point of its first leg."""
    station = course.legs[0].origin + index * SPACING
    legs = [leg for leg in course.legs if leg.origin + leg.start * SPACING < station]
    last = legs[-1]
    end = round((station - last.origin) / SPACING)
    if end < len(last.points) - 1:
        legs[-1] = _cut_leg(last, max(end, last.start + 1), course.top_speed)
    return replace(course, legs=tuple(legs))


def _cut_leg(leg: Leg, end: int, cruise: float) -> Leg:
    """The leg up to index ``end``, with a speed profile that ends in a stop there."""
    points = leg.points[: end + 1].copy()
    curvature = np.tan(points["front_wheel"].astype(float)) / WHEELBASE
    speed = speed_profile(curvature, leg.start, SpeedLimits(cruise))
    points["v"], points["acc"] = speed, accelerations(speed)
    points["heading_rate"] = speed * curvature
    return replace(leg, points=points)
