# SPDX-License-Identifier: Apache-2.0
"""Walks along a list of ``POINT`` records: a pose ahead, the stop point, the pitch."""

import numpy as np

from safety_island.control.point_list import interpolate_pose
from safety_island.control.points import distance_2d, distance_3d
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.inverse import atan2

STANDING = 1e-3
"""A point slower than this [m/s] is a stop point."""


@kernel
def pose_ahead(points, n, start, distance, out):
    """Pose ``distance`` [m] (in space) ahead of point ``start``; past the end: the last point."""
    for i in range(start, n - 1):
        length = distance_3d(points[i], points[i + 1])
        if distance < length:
            interpolate_pose(points[i], points[i + 1], max(distance, 0.0) / length, out)
            return
        distance -= length
    interpolate_pose(points[n - 1], points[n - 1], 0.0, out)


@kernel
def stop_index(points, n):
    """Index of the first stop point, also behind the ego; -1 when there is none."""
    for i in range(n):
        if abs(np.float64(points[i].v)) < STANDING:
            return i
    return -1


@kernel
def arc_length(points, start, end):
    """Signed length [m] in the plane along the list from one index to another."""
    total = 0.0
    for i in range(min(start, end), max(start, end)):
        total += distance_2d(points[i], points[i + 1])
    return total if start <= end else -total


@kernel
def stop_distance(points, n, nearest):
    """Signed length [m] from point ``nearest`` to the first stop point, else to the last point."""
    end = stop_index(points, n)
    return arc_length(points, nearest, end if end >= 0 else n - 1)


@kernel
def elevation(a, b):
    """Pitch [rad] of the line from one point to another, positive uphill."""
    return atan2(b.z - a.z, distance_2d(a, b))


@kernel
def pitch_ahead(points, n, start, wheel_base):
    """Pitch [rad] from point ``start`` to the first one more than a wheelbase away in space.

    When the list ends before that: from the last but one, if that is earlier, to the last.
    """
    for i in range(start + 1, n):
        if distance_3d(points[start], points[i]) > wheel_base:
            return elevation(points[start], points[i])
    return elevation(points[min(start, n - 2)], points[n - 1])
