"""The reference path of the MPC: the accepted trajectory, resampled by arc length at the ego.

Only positions and speeds are computed for the whole path; yaw and curvature are worked out
point by point where they are needed (``reference_shape``), which gives the same numbers.
"""

import math

from safety_island.control.geometry import clip, normalize_angle, yaw_of
from safety_island.control.kernel import kernel
from safety_island.control.limits import MAX_REFERENCE
from safety_island.control.points import nearest_index, offset_along, segment_of
from safety_island.control.reference_smoothing import smooth_reference
from safety_island.control.spline import (
    fit_space_curve,
    interval_from,
    second_derivatives,
    spline_value,
    unwrap_step,
)

_YAW_KNOTS = 48
"""Knots beyond the one asked for that a spline's value depends on in double precision: the
influence of a knot falls to a half or less with each step, so 2**-48 is left."""

_YAW_LENGTH = 3.0
"""The yaw is asked for at the first two stations, which lie within two steps of 1 m at most [m]."""


@kernel
def accept_source(points, n, lat):
    """Take over a received trajectory of n >= 3 points: arc length and spline coefficients."""
    px = lat.px
    py = lat.py
    pz = lat.pz
    pv = lat.pv
    for i in range(n):
        point = points[i]
        px[i] = point.x
        py[i] = point.y
        pz[i] = point.z
        pv[i] = point.v
    last = points[n - 1]
    lat.source_yaw_end = yaw_of(last.qx, last.qy, last.qz, last.qw)
    fit_space_curve(lat.arc, lat.gain, px, py, pz, lat.mx, lat.my, lat.mz, n)
    _fit_yaw(points, n, lat)
    lat.source_n = n


@kernel
def _fit_yaw(points, n, lat):
    """Fit the yaw spline as far as the start of the path depends on it."""
    count = min(n, _YAW_KNOTS)
    while count < n and lat.arc[count - 1] < _YAW_LENGTH:
        count += 1
    previous = 0.0
    for i in range(count):
        point = points[i]
        own = yaw_of(point.qx, point.qy, point.qz, point.qw)
        previous = own if i == 0 else unwrap_step(own, previous)
        lat.pyaw[i] = previous
    second_derivatives(lat.arc, lat.gain, lat.pyaw, lat.myaw, count)


@kernel
def _place_stations(lat, start, step):
    """Fill the arc lengths of the reference points, anchored at the ego's projection.

    Backward from clip(start), forward from max(start, 0) + step, each by running addition as the
    firmware does. Returns the number of points; the arrays hold MAX_REFERENCE at the most.
    """
    rs = lat.rs
    length = lat.arc[lat.source_n - 1]
    s = clip(start, 0.0, length - 1e-6)
    count = 0
    while s >= 0.0 and count < MAX_REFERENCE:
        rs[count] = s
        count += 1
        s -= step
    for i in range(count // 2):
        swap = rs[i]
        rs[i] = rs[count - 1 - i]
        rs[count - 1 - i] = swap
    lat.anchor = max(count - 1, 0)
    s = max(start, 0.0) + step
    while s < length and count < MAX_REFERENCE:
        rs[count] = s
        count += 1
        s += step
    return count


@kernel
def _evaluate_positions(lat, count):
    """Fill x, y, z and speed of the reference: cubic splines for positions, linear for speed."""
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
    i = 0
    j = 0
    while i < count:
        j = interval_from(arc, n, j, rs[i])
        end = math.inf if j == n - 2 else arc[j + 1]
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
        while i < count and rs[i] <= end:
            t = rs[i] - s0
            rx[i] = ((ax * t + bx) * t + cx) * t + x0
            ry[i] = ((ay * t + by) * t + cy) * t + y0
            rz[i] = ((az * t + bz) * t + cz) * t + z0
            rv[i] = v0 + slope * t
            i += 1


@kernel
def _detect_direction(lat, count):
    """Set the driving direction from the yaw of the first point; kept for a single point."""
    for i in range(min(count, 2)):
        j = interval_from(lat.arc, lat.source_n, 0, lat.rs[i])
        lat.short_yaw[i] = spline_value(lat.arc, lat.pyaw, lat.myaw, j, lat.rs[i])
    if count >= 2:
        azimuth = math.atan2(lat.ry[1] - lat.ry[0], lat.rx[1] - lat.rx[0])
        lat.is_forward = abs(normalize_angle(lat.short_yaw[0] - azimuth)) < math.pi / 2.0


@kernel
def _extend(lat, count, step):
    """Append 10 m of points along the received trajectory's last yaw, at 10 m/s."""
    sign = 1.0 if lat.is_forward else -1.0
    dx = sign * step * math.cos(lat.source_yaw_end)
    dy = sign * step * math.sin(lat.source_yaw_end)
    for _ in range(int(10.0 / step)):
        if count >= MAX_REFERENCE:
            break
        lat.rx[count] = lat.rx[count - 1] + dx
        lat.ry[count] = lat.ry[count - 1] + dy
        lat.rz[count] = lat.rz[count - 1]
        lat.rv[count] = 10.0
        count += 1
    return count


@kernel
def _close(lat, count):
    """End the path: speed zero at the last point, and the first closing duplicate."""
    lat.rv[count - 1] = 0.0
    lat.rx[count] = lat.rx[count - 1]
    lat.ry[count] = lat.ry[count - 1]
    lat.rz[count] = lat.rz[count - 1]
    lat.rv[count] = 0.0
    lat.ref_n = count


@kernel
def update_reference(params, points, inputs, lat):
    """Resample the accepted trajectory anew at the ego's projection."""
    n = lat.source_n
    yaw = yaw_of(inputs.qx, inputs.qy, inputs.qz, inputs.qw)
    nearest = nearest_index(
        points,
        n,
        inputs.x,
        inputs.y,
        yaw,
        params.ego_nearest_dist_threshold,
        params.ego_nearest_yaw_threshold,
    )
    segment = segment_of(points, n, nearest, inputs.x, inputs.y)
    start = lat.arc[segment] + offset_along(points, segment, inputs.x, inputs.y)
    count = _place_stations(lat, start, params.traj_resample_dist)
    if count == 0:  # shorter than a micrometre: nothing to follow, the old reference stays
        return
    _evaluate_positions(lat, count)
    _detect_direction(lat, count)
    if params.enable_path_smoothing and count > 2 * params.path_filter_moving_ave_num:
        smooth_reference(lat, count, params.path_filter_moving_ave_num)
    if params.extend_trajectory_for_end_yaw_control:
        count = _extend(lat, count, params.traj_resample_dist)
    _close(lat, count)
