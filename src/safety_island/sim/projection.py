"""Where a vehicle is along a leg: station, lateral error, height and slope of the road."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from safety_island.sim.courses import Leg
from safety_island.sim.shapes import SPACING

_BACK, _AHEAD = 20, 60
"""Points around the last index that are searched: a path that crosses itself stays one line."""


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


def locate(leg: Leg, index: int, x: float, y: float) -> Place:
    """Project (x, y) [m] on the leg, near the segment ``index`` where it was before."""
    low = max(index - _BACK, 0)
    points = leg.points[low : index + _AHEAD]
    nearest = low + int(np.argmin((points["x"] - x) ** 2 + (points["y"] - y) ** 2))
    last = len(leg.points) - 2
    after = _on_segment(leg, min(nearest, last), x, y)
    if nearest == 0 or nearest > last or after.station >= leg.origin + nearest * SPACING:
        return after
    return _on_segment(leg, nearest - 1, x, y)


def _on_segment(leg: Leg, index: int, x: float, y: float) -> Place:
    a, b = leg.points[index], leg.points[index + 1]
    dx, dy = float(b["x"] - a["x"]), float(b["y"] - a["y"])
    length = math.hypot(dx, dy)
    rx, ry = x - float(a["x"]), y - float(a["y"])
    ratio = (dx * rx + dy * ry) / (length * length)
    inside = min(max(ratio, 0.0), 1.0)
    rise = float(b["z"] - a["z"])
    return Place(
        segment=index,
        station=leg.origin + (index + ratio) * SPACING,
        lateral_error=(dx * ry - dy * rx) / length,
        height=float(a["z"]) + ratio * rise,
        pitch=math.atan2(rise, length),
        speed=(1.0 - inside) * float(a["v"]) + inside * float(b["v"]),
    )
