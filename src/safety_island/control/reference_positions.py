# SPDX-License-Identifier: Apache-2.0
"""Positions and speeds of the reference, from its first point as far as they are asked for.

A trajectory may be three times as long as the horizon; what lies beyond it costs nothing.
"""

import math

from safety_island.control.limits import MAX_REFERENCE
from safety_island.control.spline import interval_from
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.trigonometric import cos, sin

_STRETCH = 64
"""Points that are worked out beyond the one that was asked for."""


@kernel
def work_out(lat, end):
    """Fill x, y, z and speed up to ``end``: cubic splines for positions, linear for speed."""
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
    i = lat.ready
    j = lat.cursor
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
    lat.ready = end
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
    lat.ready = count + 1


@kernel
def ensure(lat, i):
    """Work out point ``i`` and those before it, and some beyond; returns how many are.

    ``i`` may be ``ref_n``, the first closing duplicate, at most; what lies beyond counts as that.
    Without a reference there is nothing to work out.
    """
    i = min(i, lat.ref_n)
    if i >= lat.ready and lat.ref_n > 0:
        end = min(i + _STRETCH, lat.ref_n)
        work_out(lat, end)
        if end == lat.ref_n:
            close(lat, end)
    return lat.ready
