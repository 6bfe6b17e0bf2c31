# SPDX-License-Identifier: Apache-2.0
"""The limits by speed: linear between the points, held outside."""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise

from safety_island.guard.params import GuardParams

Limits = tuple[float, float, float, float, float, float, float, float, float, float]
"""Angle, rate, rotation rate, distance; lateral acceleration and jerk; drive, brake, jerk of each.

In the order of COLUMNS.
"""

COLUMNS = (
    "steering_angle",
    "steering_rate",
    "rotation_rate",
    "steering_distance",
    "lateral_acceleration",
    "lateral_jerk",
    "acceleration",
    "deceleration",
    "jerk",
    "brake_jerk",
)
"""The lists of GuardParams."""


class SpeedTable:
    """The lists of the guard, read together."""

    def __init__(self, params: GuardParams) -> None:
        self._points = params.speed_points
        lists = (getattr(params, name) for name in COLUMNS)
        at_points = tuple(zip(*lists, strict=True))
        flat = (0.0,) * len(COLUMNS)
        spans = zip(pairwise(self._points), pairwise(at_points), strict=True)
        self._lines = (
            (0.0, at_points[0], flat),
            *((a, first, _slopes(b - a, first, last)) for (a, b), (first, last) in spans),
            (0.0, at_points[-1], flat),
        )
        pairs = pairwise((at_points[0], *at_points, at_points[-1]))
        self._strictest = tuple(tuple(map(min, *pair)) for pair in pairs)

    def strictest(self, speed: float) -> Limits:
        """Return limits that are the strictest between two points, at a speed [m/s]."""
        return self._strictest[bisect_right(self._points, speed)]

    def at(self, speed: float) -> Limits:
        """Return the limits at a speed [m/s]. Written out, for a loop takes three times as long."""
        start, first, slope = self._lines[bisect_right(self._points, speed)]
        beyond = speed - start
        a, b, c, d, e, f, g, h, i, j = first
        p, q, r, s, t, u, v, w, x, y = slope
        return (
            a + p * beyond,
            b + q * beyond,
            c + r * beyond,
            d + s * beyond,
            e + t * beyond,
            f + u * beyond,
            g + v * beyond,
            h + w * beyond,
            i + x * beyond,
            j + y * beyond,
        )


def _slopes(width: float, first: tuple[float, ...], last: tuple[float, ...]) -> tuple[float, ...]:
    return tuple((b - a) / width for a, b in zip(first, last, strict=True))
