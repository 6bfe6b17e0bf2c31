# SPDX-License-Identifier: Apache-2.0
"""Yaw, curvature and the ego's place on the reference path, computed where they are asked for.

Yaw and curvature read points around the one that they are asked for, which must be worked out.
"""

import math

from safety_island.control.geometry import clear_turn, cosine_of_limit, normalize_angle
from safety_island.control.reference_positions import ensure
from safety_island.control.spline import interval_from
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.inverse import atan2
from safety_island.kernel.math.trigonometric import cos, sin

TOO_CLOSE = 1e-3
"""Points of the reference nearer than this [m] give no direction and no curvature."""

_ROUNDING = 1e-6
"""More than rounding can shift a position [m]."""


@kernel
def _is_short(lat, i, j):
    """Whether two points of the reference are too close together to give a direction."""
    dx = lat.rx[j] - lat.rx[i]
    dy = lat.ry[j] - lat.ry[i]
    return dx * dx + dy * dy < TOO_CLOSE * TOO_CLOSE


@kernel
def _has_close_neighbours(lat, i):
    """Whether point ``i`` and those on either side are too close together to give a direction."""
    return _is_short(lat, i - 1, i + 1) or _is_short(lat, i - 1, i) or _is_short(lat, i, i + 1)


@kernel
def starts_close(lat):
    """Whether the first points of a reference of three or more are too close together."""
    return _has_close_neighbours(lat, 1)


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
        ensure(lat, i - 1, i + 1)
        if not _has_close_neighbours(lat, i):
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
        ensure(lat, i - span, i + span)


@kernel
def ensure_yaw(lat, low, high):
    """Ask for what ``yaw_at`` reads of points low <= i <= high; at the ends that is inside."""
    ensure(lat, min(low, lat.ref_n - 2) - 1, max(high, 1) + 1)


@kernel
def ensure_curvature(lat, low, high, reach):
    """Ask for what ``curvature_at`` reads of points low <= i <= high, up to this reach.

    At the ends the nearest curvature counts that there is, whose points lie further inside.
    """
    ensure(lat, min(low, lat.ref_n - 1 - reach) - reach, max(high, reach) + reach)


@kernel
def _station_beyond(lat, s):
    """Index of the first point whose station is beyond arc length ``s``; ref_n when none is."""
    n = lat.ref_n
    rs = lat.rs
    step = (rs[n - 1] - rs[0]) / max(n - 1, 1)
    i = min(max(int((s - rs[0]) / step), 0), n - 1) if step > 0.0 else 0
    while i > 0 and rs[i - 1] > s:
        i -= 1
    while i < n and rs[i] <= s:
        i += 1
    return i


@kernel
def _next_near(lat, i, x, y, limit):
    """The first point from ``i`` on that may lie within ``limit`` [m] of (x, y); else ref_n + 1.

    A point lies on the curve of an interval of the source, so within ``bulge`` of one of its ends.
    An interval with both ends further away than limit + bulge has no such point.
    """
    end = lat.ref_n
    if not lat.is_on_splines or i >= end:
        return i
    start = interval_from(lat.arc, lat.source_n, lat.near_interval if i > 0 else 0, lat.rs[i])
    j = _near_interval(lat, start, x, y, limit + lat.bulge + _ROUNDING)
    if j < 0:
        return end + 1
    lat.near_interval = j
    return i if j == start else _station_beyond(lat, lat.arc[j])


@kernel
def _near_interval(lat, j, x, y, reach):
    """The first interval of the source from ``j`` on with an end within ``reach`` [m]; -1: none.

    The path does not come nearer by more than its length, so many ends need not be looked at.
    """
    last = lat.source_n - 1
    while True:
        distance = _distance(lat, j, x, y)
        if distance <= reach:
            return j
        ahead = lat.arc[j] + (distance - reach)
        while j < last and lat.arc[j + 1] < ahead:
            j += 1
        if j == last:
            return -1
        if _distance(lat, j + 1, x, y) <= reach:
            return j
        j += 1


@kernel
def _distance(lat, j, x, y):
    """Distance [m] of point ``j`` of the source from (x, y)."""
    dx = lat.px[j] - x
    dy = lat.py[j] - y
    return math.sqrt(dx * dx + dy * dy)


@kernel
def _plain_direction(lat, i):
    """Where the vehicle faces at point ``i`` by central differences; (0, 0) where another rule is.

    What ``yaw_at`` takes the angle of, at most points.
    """
    if lat.is_timed or i < 1 or i > lat.ref_n - 2:
        return 0.0, 0.0
    if lat.one_sided_ends and _has_close_neighbours(lat, i):
        return 0.0, 0.0
    sign = 1.0 if lat.is_forward else -1.0
    return sign * (lat.rx[i + 1] - lat.rx[i - 1]), sign * (lat.ry[i + 1] - lat.ry[i - 1])


@kernel
def _nearest_within(lat, x, y, yaw, dist_limit, yaw_limit):
    """Nearest point of the first run of points within both limits; -1 when there is none."""
    best = -1
    best_squared = math.inf
    has_yaw_limit = yaw_limit < math.inf
    cos_yaw, sin_yaw = cos(yaw), sin(yaw)
    cos_limit = cosine_of_limit(yaw_limit) if has_yaw_limit else 0.0
    i = _next_near(lat, 0, x, y, dist_limit)
    while i <= lat.ref_n:
        ensure_yaw(lat, i, i)
        dx = lat.rx[i] - x
        dy = lat.ry[i] - y
        squared = dx * dx + dy * dy
        inside = squared <= dist_limit * dist_limit
        if inside and has_yaw_limit:
            dx, dy = _plain_direction(lat, i)
            clear = clear_turn(dx, dy, cos_yaw, sin_yaw, cos_limit)
            turn = 0.0 if clear != 0 else normalize_angle(yaw_at(lat, i) - yaw)
            inside = clear > 0 or (clear == 0 and abs(turn) <= yaw_limit)
        if inside:
            if squared < best_squared:
                best_squared = squared
                best = i
            i += 1
        elif best >= 0:
            break
        else:
            i = _next_near(lat, i + 1, x, y, dist_limit)
    return best


@kernel
def _nearest_global(lat, x, y):
    """Nearest point of all; of equals the first."""
    limit = _distance_of_anchor(lat, x, y)
    best = 0
    best_squared = math.inf
    i = _next_near(lat, 0, x, y, limit)
    while i < lat.ref_n:
        ensure(lat, i, i)
        dx = lat.rx[i] - x
        dy = lat.ry[i] - y
        squared = dx * dx + dy * dy
        if squared < best_squared:
            best_squared = squared
            best = i
        i = _next_near(lat, i + 1, x, y, limit)
    return best


@kernel
def _distance_of_anchor(lat, x, y):
    """Distance [m] of the point at the ego's projection: the nearest one is not further away."""
    if not lat.is_on_splines:
        return math.inf
    ensure(lat, lat.anchor, lat.anchor)
    dx = lat.rx[lat.anchor] - x
    dy = lat.ry[lat.anchor] - y
    return math.sqrt(dx * dx + dy * dy)


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
    ensure(lat, nearest - 1, nearest + 1)
    dx = lat.rx[nearest + 1] - lat.rx[nearest]
    dy = lat.ry[nearest + 1] - lat.ry[nearest]
    if abs(dx) < 1e-8 and abs(dy) < 1e-8:
        return nearest
    along = dx * (x - lat.rx[nearest]) + dy * (y - lat.ry[nearest])
    return nearest - 1 if along <= 0.0 else nearest
