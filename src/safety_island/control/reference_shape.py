# SPDX-License-Identifier: Apache-2.0
"""Yaw, curvature and the ego's place on the reference path, computed where they are asked for.

Yaw and curvature read points around the one that they are asked for, which must be worked out.
"""

import math

from safety_island.control.geometry import normalize_angle
from safety_island.control.reference_positions import ensure
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.inverse import atan2

TOO_CLOSE = 1e-3
"""Points of the reference nearer than this [m] give no direction and no curvature."""


@kernel
def _is_short(lat, i, j):
    """Whether two points of the reference are too close together to give a direction."""
    dx = lat.rx[j] - lat.rx[i]
    dy = lat.ry[j] - lat.ry[i]
    return dx * dx + dy * dy < TOO_CLOSE * TOO_CLOSE


@kernel
def starts_close(lat):
    """Whether the first points of a reference of three or more are too close together."""
    return _is_short(lat, 0, 1) or _is_short(lat, 1, 2) or _is_short(lat, 0, 2)


@kernel
def _direction(lat, i, j):
    """Yaw [rad] of the vehicle on the line from point ``i`` to point ``j``."""
    yaw = atan2(lat.ry[j] - lat.ry[i], lat.rx[j] - lat.rx[i])
    return yaw if lat.is_forward else yaw + math.pi


@kernel
def _yaw_one_sided(lat, i):
    """Yaw [rad] of point ``i`` of at least three; too close together: that of the one before."""
    last = lat.ref_n - 1
    if i == 0 and not _is_short(lat, 0, 1):
        return _direction(lat, 0, 1)
    if i == last and not _is_short(lat, last - 1, last):
        return _direction(lat, last - 1, last)
    i = min(max(i, 1), last - 1)
    while i > 0:
        close = _is_short(lat, i - 1, i + 1) or _is_short(lat, i - 1, i) or _is_short(lat, i, i + 1)
        if not close:
            return _direction(lat, i - 1, i + 1)
        i -= 1
    return lat.short_yaw[0]


@kernel
def yaw_at(lat, i):
    """Yaw [rad] of reference point ``i`` by central differences, not unwrapped; ends copied.

    By the rule ``one_sided_ends`` the ends have the yaw of the end segments.
    """
    n = lat.ref_n
    if lat.is_timed:
        return lat.ryaw[min(i, n + 1)]
    if n < 3:
        return lat.short_yaw[min(i, n - 1)]
    if lat.one_sided_ends:
        return _yaw_one_sided(lat, min(i, n - 1))
    i = min(max(i, 1), n - 2)
    yaw = atan2(lat.ry[i + 1] - lat.ry[i - 1], lat.rx[i + 1] - lat.rx[i - 1])
    return yaw if lat.is_forward else yaw + math.pi


@kernel
def menger_curvature(x1, y1, x2, y2, x3, y3):
    """Curvature [1/m] of the circle through three points, positive to the left.

    The second result says whether they lie far enough apart to give one.
    """
    a = (x2 - x1) * (x2 - x1) + (y2 - y1) * (y2 - y1)
    b = (x3 - x2) * (x3 - x2) + (y3 - y2) * (y3 - y2)
    c = (x1 - x3) * (x1 - x3) + (y1 - y3) * (y1 - y3)
    product = math.sqrt(a * b * c)
    if product < 1e-10:
        return 0.0, False
    area = 2.0 * ((x2 - x1) * (y3 - y1) - (y2 - y1) * (x3 - x1))
    return area / product, min(a, b, c) >= TOO_CLOSE * TOO_CLOSE


@kernel
def curvature_at(lat, i, reach):
    """Menger curvature [1/m] of points i-L, i, i+L, positive to the left; ends copied.

    By the rule ``one_sided_ends`` points too close together have the curvature of those before.
    """
    n = lat.ref_n
    if lat.is_timed:
        return lat.rk[i] if reach == lat.curvature_reach else lat.rks[i]
    span = min(reach, (n - 1) // 2)
    i = min(max(i, span), n - 1 - span)
    while True:
        a = i - span
        b = i + span
        curvature, is_defined = menger_curvature(
            lat.rx[a], lat.ry[a], lat.rx[i], lat.ry[i], lat.rx[b], lat.ry[b]
        )
        if is_defined or not lat.one_sided_ends:
            return curvature
        i -= 1
        if i < span:
            return 0.0


@kernel
def _nearest_within(lat, x, y, yaw, dist_limit, yaw_limit):
    best = -1
    best_squared = math.inf
    rx = lat.rx
    ry = lat.ry
    ready = 0
    for i in range(lat.ref_n + 1):
        if i + 1 >= ready:  # the yaw reads the point behind
            ready = ensure(lat, i + 1)
        dx = rx[i] - x
        dy = ry[i] - y
        squared = dx * dx + dy * dy
        inside = squared <= dist_limit * dist_limit
        if inside and yaw_limit < math.inf:
            inside = abs(normalize_angle(yaw_at(lat, i) - yaw)) <= yaw_limit
        if inside:
            if squared < best_squared:
                best_squared = squared
                best = i
        elif best >= 0:
            break
    return best


@kernel
def _nearest_global(lat, x, y):
    ensure(lat, lat.ref_n)
    best = 0
    best_squared = math.inf
    rx = lat.rx
    ry = lat.ry
    for i in range(lat.ref_n):
        dx = rx[i] - x
        dy = ry[i] - y
        squared = dx * dx + dy * dy
        if squared < best_squared:
            best_squared = squared
            best = i
    return best


@kernel
def nearest_on_reference(lat, x, y, yaw, dist_limit, yaw_limit):
    """Nearest reference point with the soft limits of ``points.nearest_index``."""
    best = -1
    if dist_limit > 0.0:
        best = _nearest_within(lat, x, y, yaw, dist_limit, yaw_limit)
        if best < 0:
            best = _nearest_within(lat, x, y, yaw, dist_limit, math.inf)
    if best < 0:
        best = _nearest_global(lat, x, y)
    return best


@kernel
def segment_on_reference(lat, nearest, x, y):
    """Segment of the closed reference that holds the projection of (x, y).

    On the closing segment, which has no length, the nearest point itself is taken.
    """
    if nearest <= 0:
        return 0
    ensure(lat, nearest + 1)
    dx = lat.rx[nearest + 1] - lat.rx[nearest]
    dy = lat.ry[nearest + 1] - lat.ry[nearest]
    if abs(dx) < 1e-8 and abs(dy) < 1e-8:
        return nearest
    along = dx * (x - lat.rx[nearest]) + dy * (y - lat.ry[nearest])
    return nearest - 1 if along <= 0.0 else nearest
