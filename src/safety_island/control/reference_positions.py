# SPDX-License-Identifier: Apache-2.0
"""Positions and speeds of the reference, worked out where they are read and nowhere else.

A trajectory may be three times as long as the horizon, and it begins behind the vehicle. So of the
reference only one stretch without gaps, the points ``first`` <= i < ``ready``, holds numbers: it
grows, at either end, to hold whatever is asked for with ``ensure``. The one invariant:

    No point is read that was not asked for, and what stands in the stretch is what would stand
    there if the whole reference had been worked out.

It rests on the splines of the source. Where the points are not on them any more (smoothed,
extended, received with times, or of a trajectory before the present one) all of them are in the
stretch, and nothing can be added.
"""

import math

from safety_island.control.limits import MAX_REFERENCE
from safety_island.control.spline import interval_from
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.trigonometric import cos, sin

_STRETCH = 16
"""Points that are worked out beyond the last one that was asked for."""


@kernel
def work_out(lat, begin, end):
    """Fill x, y, z and speed of points begin <= i < end: cubic splines, linear for speed."""
    arc = lat.arc
    px = lat.px
    py = lat.py
    pz = lat.pz
    pv = lat.pv
    mx = lat.mx
    my = lat.my
    mz = lat.mz
    rs = lat.rs
    rx = lat.rx
    ry = lat.ry
    rz = lat.rz
    rv = lat.rv
    n = lat.source_n
    i = begin
    j = lat.cursor if begin < end and rs[begin] > arc[lat.cursor] else 0
    while i < end:
        j = interval_from(arc, n, j, rs[i])
        last = math.inf if j == n - 2 else arc[j + 1]
        h = arc[j + 1] - arc[j]
        inverse = 1.0 / h
        sixth = h / 6.0
        ax = (mx[j + 1] - mx[j]) * inverse / 6.0
        ay = (my[j + 1] - my[j]) * inverse / 6.0
        az = (mz[j + 1] - mz[j]) * inverse / 6.0
        bx = mx[j] / 2.0
        by = my[j] / 2.0
        bz = mz[j] / 2.0
        cx = (px[j + 1] - px[j]) * inverse - sixth * (2.0 * mx[j] + mx[j + 1])
        cy = (py[j + 1] - py[j]) * inverse - sixth * (2.0 * my[j] + my[j + 1])
        cz = (pz[j + 1] - pz[j]) * inverse - sixth * (2.0 * mz[j] + mz[j + 1])
        slope = (pv[j + 1] - pv[j]) * inverse
        # held in locals: the compiler must suppose that the stores below change the arrays
        s0 = arc[j]
        x0 = px[j]
        y0 = py[j]
        z0 = pz[j]
        v0 = pv[j]
        while i < end and rs[i] <= last:
            t = rs[i] - s0
            rx[i] = ((ax * t + bx) * t + cx) * t + x0
            ry[i] = ((ay * t + by) * t + cy) * t + y0
            rz[i] = ((az * t + bz) * t + cz) * t + z0
            rv[i] = v0 + slope * t
            i += 1
    lat.cursor = j


@kernel
def extend(params, lat, count):
    """Append 10 m of points along the received trajectory's last yaw.

    They have the speed of the last point, or by the older rule 10 m/s, also in reverse.
    """
    step = params.traj_resample_dist
    speed = lat.rv[count - 1] if params.extends_with_end_speed else 10.0
    sign = 1.0 if lat.is_forward else -1.0
    dx = sign * step * cos(lat.source_yaw_end)
    dy = sign * step * sin(lat.source_yaw_end)
    for _ in range(int(10.0 / step)):
        if count >= MAX_REFERENCE:
            break
        lat.rx[count] = lat.rx[count - 1] + dx
        lat.ry[count] = lat.ry[count - 1] + dy
        lat.rz[count] = lat.rz[count - 1]
        lat.rv[count] = speed
        count += 1
    return count


@kernel
def close(lat, count):
    """End the path: speed zero at the last point, and the first closing duplicate."""
    lat.rv[count - 1] = 0.0
    lat.rx[count] = lat.rx[count - 1]
    lat.ry[count] = lat.ry[count - 1]
    lat.rz[count] = lat.rz[count - 1]
    lat.rv[count] = 0.0
    lat.ref_n = count


@kernel
def work_out_whole(lat, count):
    """Fill all ``count`` points, so that they can be changed; ``close`` them then."""
    work_out(lat, 0, count)
    lat.first = 0
    lat.ready = MAX_REFERENCE + 1
    lat.is_on_splines = False


@kernel
def leave_source(lat):
    """Work out what is left of the reference, because the splines of its source will change."""
    if lat.is_on_splines:
        ensure(lat, 0, lat.ref_n)
        lat.is_on_splines = False


@kernel
def ensure(lat, low, high):
    """Have the points low <= i <= high in the stretch; returns ``ready``, its end.

    ``ref_n``, the first closing duplicate, is the last point; bounds beyond the ends count as
    these.
    """
    if lat.is_on_splines and (low < lat.first or high >= lat.ready):
        _widen(lat, max(low, 0), min(high, lat.ref_n))
    return lat.ready


@kernel
def _widen(lat, low, high):
    """Let the stretch reach from ``low`` or before to ``high`` or beyond."""
    if lat.first == lat.ready:  # it holds nothing yet; the closing duplicate needs the point before
        lat.first = lat.ready = min(low, lat.ref_n - 1)
    if low < lat.first:
        work_out(lat, low, lat.first)
        lat.first = low
    if high >= lat.ready:
        end = min(high + _STRETCH, lat.ref_n)
        work_out(lat, lat.ready, end)
        lat.ready = end
        if end == lat.ref_n:
            close(lat, end)
            lat.ready = end + 1
