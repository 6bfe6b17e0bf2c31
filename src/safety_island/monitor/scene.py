# SPDX-License-Identifier: Apache-2.0
"""What the top view draws: the vehicle, where it is, and the paths, cut to what a screen shows."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safety_island.messages.inputs import Odometry
from safety_island.messages.points import Points
from safety_island.monitor.fields import rounded
from safety_island.params import IslandParameters

MOST_POINTS = 200
"""Of a path on its way to the page."""
CENTIMETRES = 2
"""Decimals of a position [m]."""


def heading(odometry: Odometry) -> float:
    """Return the yaw [rad] of a pose."""
    _, _, _, _, _, _, qx, qy, qz, qw, *_ = odometry
    return math.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))


def pose_values(now: float, odometry: Odometry, steering: float) -> dict[str, Any] | None:
    """Return the pose at ``now`` [s] and the tyre angle [rad]; None when it is no number."""
    place = (odometry.x, odometry.y, heading(odometry))
    if not all(map(math.isfinite, place)):
        return None
    x, y, yaw = place
    return {
        "t": round(now, 3),
        "x": round(x, CENTIMETRES + 1),
        "y": round(y, CENTIMETRES + 1),
        "yaw": round(yaw, 4),
        "steering": rounded(steering),
    }


def path_values(points: Points) -> dict[str, list[float]]:
    """Return places [m] and speeds [m/s] of a trajectory, first and last among them.

    Points that are no numbers are left out: the island refuses such a trajectory, and says so.
    """
    count = min(len(points), MOST_POINTS)
    kept = points[np.linspace(0, len(points) - 1, count).round().astype(int)]
    columns = np.array([kept[name] for name in ("x", "y", "v")], float)
    finite = columns[:, np.isfinite(columns).all(axis=0)].round(CENTIMETRES)
    return dict(zip("xyv", finite.tolist(), strict=True))


def vehicle_values(parameters: IslandParameters) -> dict[str, float]:
    """Return the dimensions of the vehicle [m] and its largest tyre angle [rad]."""
    vehicle = parameters.vehicle
    names = (
        "wheel_radius",
        "wheel_width",
        "wheel_base",
        "wheel_tread",
        "front_overhang",
        "rear_overhang",
        "left_overhang",
        "right_overhang",
        "max_steer_angle",
    )
    return {name: getattr(vehicle, name) for name in names}
