# SPDX-License-Identifier: Apache-2.0
"""Where a vehicle is along a leg: station, lateral error, height and slope of the road."""

from __future__ import annotations

import math
from typing import NamedTuple

from safety_island.sim.courses import Leg
from safety_island.sim.shapes import SPACING


class Place(NamedTuple):
    """A position along a leg."""

    segment: int
    """Index of the segment (index, index + 1) of the leg's points."""
    station: float
    """Arc length [m] from the start of the course; beyond the ends the end segments go on."""
    lateral_error: float
    """Distance [m] from the path, positive to the left of it."""
    height: float
    """z of the road [m]."""
    pitch: float
    """Slope of the road [rad], positive uphill."""
    speed: float
    """Speed of the profile [m/s]."""


def locate(leg: Leg, segment: int, x: float, y: float) -> Place:
    """Project (x, y) [m] on the leg, walking from the segment where it was before.

    The walk goes downhill in distance, so on a path that crosses itself it stays on its branch.
    """
    xs, ys = leg.columns[:2]
    last = len(xs) - 1

    def squared(i: int) -> float:
        return (xs[i] - x) ** 2 + (ys[i] - y) ** 2

    nearest, best = segment, squared(segment)
    for step in (1, -1):
        while 0 <= nearest + step <= last and (closer := squared(nearest + step)) < best:
            nearest, best = nearest + step, closer
    after = _on_segment(leg, min(nearest, last - 1), x, y)
    if nearest in (0, last) or after.station >= leg.origin + nearest * SPACING:
        return after
    return _on_segment(leg, nearest - 1, x, y)


def _on_segment(leg: Leg, segment: int, x: float, y: float) -> Place:
    xs, ys, zs, speeds = leg.columns
    end = segment + 1
    dx, dy = xs[end] - xs[segment], ys[end] - ys[segment]
    length = math.hypot(dx, dy)
    rx, ry = x - xs[segment], y - ys[segment]
    ratio = (dx * rx + dy * ry) / (length * length)
    inside = min(max(ratio, 0.0), 1.0)
    rise = zs[end] - zs[segment]
    return Place(
        segment=segment,
        station=leg.origin + (segment + ratio) * SPACING,
        lateral_error=(dx * ry - dy * rx) / length,
        height=zs[segment] + ratio * rise,
        pitch=math.atan2(rise, length),
        speed=(1.0 - inside) * speeds[segment] + inside * speeds[end],
    )
