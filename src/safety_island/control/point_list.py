# SPDX-License-Identifier: Apache-2.0
"""Lists of ``POINT`` records without overlaps: copy, interpolate, insert."""

import numpy as np

from safety_island.control.points import distance_2d, offset_along
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.inverse import acos
from safety_island.kernel.math.trigonometric import sin

SAME_PLACE = 1e-8
"""Two points nearer than this [m], in x and in y, are one, as in Autoware."""


@kernel
def overlaps(a, b):
    """Whether two points stand in the same place: closer than SAME_PLACE in x and in y."""
    return abs(a.x - b.x) < SAME_PLACE and abs(a.y - b.y) < SAME_PLACE


@kernel
def copy_distinct(points, n, target):
    """Copy points into ``target`` without those that overlap the one before; return how many."""
    count = 0
    last = -1
    for i in range(n):
        if last < 0 or not overlaps(points[i], points[last]):
            target[count] = points[i]
            count += 1
            last = i
    return count


@kernel
def insert_point(points, n, at, point):
    """Insert ``point`` before index ``at`` (1 or more) of a list; return how many there are now.

    The list stays without overlaps: a point on top of its predecessor is left out, and followers
    that it covers go.
    """
    if overlaps(points[at - 1], point):
        return n
    follower = at
    while follower < n and overlaps(points[follower], point):
        follower += 1
    if follower == at:
        for i in range(n, at, -1):
            points[i] = points[i - 1]
    else:
        for i in range(follower, n):
            points[i - follower + at + 1] = points[i]
    points[at] = point
    return n + 1 - (follower - at)


@kernel
def insert_plainly(points, n, at, point):
    """Insert ``point`` before index ``at``, also on top of another; return how many there are."""
    for i in range(n, at, -1):
        points[i] = points[i - 1]
    points[at] = point
    return n + 1


@kernel
def between(a, b, ratio):
    """Linear interpolation in double precision, also of ``float32`` values."""
    start = np.float64(a)
    return start + ratio * (np.float64(b) - start)


@kernel
def interpolate_pose(a, b, ratio, out):
    """Pose between two points: position linear, orientation on the shorter great circle."""
    out.x = between(a.x, b.x, ratio)
    out.y = between(a.y, b.y, ratio)
    out.z = between(a.z, b.z, ratio)
    dot = a.qx * b.qx + a.qy * b.qy + a.qz * b.qz + a.qw * b.qw
    if abs(dot) < 1.0 - 2.220446049250313e-16:
        angle = acos(abs(dot))
        whole = sin(angle)
        first = sin((1.0 - ratio) * angle) / whole
        second = sin(ratio * angle) / whole
    else:
        first = 1.0 - ratio
        second = ratio
    if dot < 0.0:
        second = -second
    out.qx = first * a.qx + second * b.qx
    out.qy = first * a.qy + second * b.qy
    out.qz = first * a.qz + second * b.qz
    out.qw = first * a.qw + second * b.qw


@kernel
def interpolate_at(points, segment, x, y, out):
    """The trajectory at the projection of (x, y) on a segment, held at the segment's ends.

    Speeds and accelerations are rounded to ``float32``, as a message holds them.
    """
    a = points[segment]
    b = points[segment + 1]
    length = distance_2d(a, b)
    ratio = 0.0
    if length > 0.0:
        ratio = min(max(offset_along(points, segment, x, y) / length, 0.0), 1.0)
    interpolate_point(a, b, ratio, out)


@kernel
def interpolate_point(a, b, ratio, out):
    """The trajectory between two points; speeds and accelerations as ``float32``."""
    interpolate_pose(a, b, ratio, out)
    out.v = np.float32(between(a.v, b.v, ratio))
    out.v_lat = np.float32(between(a.v_lat, b.v_lat, ratio))
    out.acc = np.float32(between(a.acc, b.acc, ratio))
    out.heading_rate = np.float32(between(a.heading_rate, b.heading_rate, ratio))
