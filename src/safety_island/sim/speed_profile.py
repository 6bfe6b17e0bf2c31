# SPDX-License-Identifier: Apache-2.0
"""The speed along a path: as fast as curvature and accelerations allow, zero at its end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safety_island.sim.shapes import SPACING, Floats


@dataclass(frozen=True)
class SpeedLimits:
    """Limits of speed [m/s], of accelerations [m/s^2], and the speed that a leg starts with."""

    cruise: float | Floats
    """One for all points, or one for each."""
    lateral: float = 1.5
    acceleration: float = 1.0
    deceleration: float = 0.8
    engage: float = 0.25
    """A path that began with speed zero would tell the controller to stay where it is."""


def speed_profile(curvature: Floats, start: int, limits: SpeedLimits) -> Floats:
    """Speeds [m/s] at the points: ``engage`` up to index ``start``, 0 at the last point.

    Forward and backward pass over v^2, as v^2 changes by 2 a ds from one point to the next.
    """
    bend = np.maximum(np.abs(curvature), 1e-9)
    squared = np.minimum(np.square(limits.cruise), limits.lateral / bend)
    squared[: start + 1] = limits.engage**2
    squared[-1] = 0.0
    for i in range(start + 1, len(squared)):
        squared[i] = min(squared[i], squared[i - 1] + 2.0 * limits.acceleration * SPACING)
    for i in range(len(squared) - 2, start, -1):
        squared[i] = min(squared[i], squared[i + 1] + 2.0 * limits.deceleration * SPACING)
    speed: Floats = np.sqrt(squared)
    return speed


def accelerations(speed: Floats) -> Floats:
    """Accelerations [m/s^2] at the points: what the segment that follows asks for."""
    along = np.diff(speed**2) / (2.0 * SPACING)
    return np.append(along, along[-1])


def travel_time(speed: Floats) -> float:
    """Time [s] that the points take at their own speed, each segment at its mean."""
    return float(np.sum(2.0 * SPACING / np.maximum(speed[:-1] + speed[1:], 1e-3)))
