# SPDX-License-Identifier: Apache-2.0
"""Search and distances on a trajectory of ``POINT`` records."""

import math

from safety_island.control.geometry import (
    clear_turn,
    cosine_of_limit,
    heading_of,
    normalize_angle,
)
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.inverse import atan2
from safety_island.kernel.math.trigonometric import cos, sin


@kernel
def time_of(points, i, start):
    """time_from_start [s] of point ``i``: each record holds that of the next point."""
    if i == 0:
        return start
    return points[i - 1].sec + points[i - 1].nanosec * 1e-9


@kernel
def _global_nearest(points, n, x, y):
    """Nearest point and its squared distance; of equals the first."""
    best = 0
    best_squared = math.inf
    for i in range(n):
        point = points[i]
        dx = point.x - x
        dy = point.y - y
        squared = dx * dx + dy * dy
        if squared < best_squared:
            best_squared = squared
            best = i
            if squared == 0.0:  # none is nearer
                break
    return best, best_squared


@kernel
def _nearest_within(points, n, x, y, yaw, limit_squared, yaw_limit):
    """Nearest point of the first run of points within both limits; -1 when there is none."""
    best = -1
    best_squared = math.inf
    has_yaw_limit = yaw_limit < math.inf
    cos_yaw, sin_yaw = cos(yaw), sin(yaw)
    cos_limit = cosine_of_limit(yaw_limit) if has_yaw_limit else 0.0
    for i in range(n):
        point = points[i]
        dx = point.x - x
        dy = point.y - y
        squared = dx * dx + dy * dy
        inside = squared <= limit_squared
        if inside and has_yaw_limit:
            cos_own, sin_own = heading_of(point.qx, point.qy, point.qz, point.qw)
            clear = clear_turn(cos_own, sin_own, cos_yaw, sin_yaw, cos_limit)
            turn = 0.0 if clear != 0 else normalize_angle(atan2(sin_own, cos_own) - yaw)
            inside = clear > 0 or (clear == 0 and abs(turn) <= yaw_limit)
        if inside:
            if squared < best_squared:
                best_squared = squared
                best = i
        elif best >= 0:
            break
    return best


@kernel
def nearest_position(points, n, x, y):
    """Nearest point to a position, without limits; of equals the first."""
    return _global_nearest(points, n, x, y)[0]


@kernel
def nearest_index(points, n, x, y, yaw, dist_limit, yaw_limit):
    """Nearest point with soft limits: both, else the distance alone, else the global nearest.

    Under a limit only the first run of points inside it counts; of equals the first. ``x``, ``y``
    [m], ``yaw`` [rad]; limits [m], [rad]. When even the global nearest is beyond the distance limit
    it is the answer. Autoware: findFirstNearestIndexWithSoftConstraints.
    """
    nearest, squared = _global_nearest(points, n, x, y)
    limit_squared = dist_limit * dist_limit
    if squared > limit_squared:
        return nearest
    best = _nearest_within(points, n, x, y, yaw, limit_squared, yaw_limit)
    if best < 0:
        best = _nearest_within(points, n, x, y, yaw, limit_squared, math.inf)
    return best if best >= 0 else nearest


@kernel
def offset_along(points, segment, x, y):
    """Signed 2-D offset [m] of (x, y) along a segment; 0 when it has no length."""
    a = points[segment]
    b = points[segment + 1]
    dx = b.x - a.x
    dy = b.y - a.y
    length = math.sqrt(dx * dx + dy * dy)
    if length == 0.0:
        return 0.0
    return (dx * (x - a.x) + dy * (y - a.y)) / length


@kernel
def segment_of(points, n, nearest, x, y):
    """Segment that holds the projection of (x, y), given the nearest point."""
    if nearest <= 0:
        return 0
    if nearest >= n - 1:
        return n - 2
    return nearest - 1 if offset_along(points, nearest, x, y) <= 0.0 else nearest


@kernel
def distance_2d(a, b):
    """Distance [m] of two points in the plane."""
    dx = b.x - a.x
    dy = b.y - a.y
    return math.sqrt(dx * dx + dy * dy)


@kernel
def distance_3d(a, b):
    """Distance [m] of two points in space."""
    dx = b.x - a.x
    dy = b.y - a.y
    dz = b.z - a.z
    return math.sqrt(dx * dx + dy * dy + dz * dz)


@kernel
def advance(point, dx, dy):
    """How far a step [m] leads in the direction that a point faces, and how far to its left."""
    cos_yaw = 1.0 - 2.0 * (point.qy * point.qy + point.qz * point.qz)
    sin_yaw = 2.0 * (point.qw * point.qz + point.qx * point.qy)
    return dx * cos_yaw + dy * sin_yaw, dy * cos_yaw - dx * sin_yaw
