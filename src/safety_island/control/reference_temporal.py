# SPDX-License-Identifier: Apache-2.0
"""The reference path of the temporal mode: the points as received, each at the time it is due.

Autoware since 0.53 (``trajectory_reference_mode: temporal``): the clock says where the vehicle
should be, not its position. All of the reference depends on the trajectory alone, so it is computed
once for each one that is accepted.
"""

import math

from safety_island.control.geometry import clip, normalize_angle, yaw_of
from safety_island.control.points import time_of
from safety_island.control.reference_positions import extend
from safety_island.control.reference_shape import TOO_CLOSE, menger_curvature
from safety_island.control.reference_smoothing import moving_average, smooth_reference
from safety_island.control.spline import (
    elimination_factors,
    interval_from,
    second_derivatives,
    spline_value,
    unwrap_step,
)
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.inverse import atan2

_TAIL = 100.0  # seconds that each closing duplicate stands still
_SHORTEST = 1e-4  # s, that a step takes
_STANDING = 0.1  # m/s
_LENGTH_OF_NOTHING = 1e-6  # m


@kernel
def accept_timed(params, points, inputs, lat):
    """Take over a received trajectory of n >= 3 points as the reference itself."""
    n = inputs.n_points
    _copy(points, n, inputs.trajectory_start, lat)
    azimuth = atan2(lat.ry[1] - lat.ry[0], lat.rx[1] - lat.rx[0])
    lat.is_forward = abs(normalize_angle(lat.ryaw[0] - azimuth)) < math.pi / 2.0
    reach = params.path_filter_moving_ave_num
    if params.enable_path_smoothing and n > 2 * reach:
        smooth_reference(lat, n, reach)
        moving_average(lat.ryaw, lat.smooth, n, reach)
    if params.extend_trajectory_for_end_yaw_control:
        n = _extend(params, lat, n)
    _fill_yaw(lat, n)
    lat.curvature_reach = params.curvature_smoothing_num_traj
    _fill_curvature(params, lat, n, lat.curvature_reach, lat.rk)
    _fill_curvature(params, lat, n, params.curvature_smoothing_num_ref_steer, lat.rks)
    _close(lat, n)


@kernel
def _copy(points, n, start, lat):
    """Positions, unwrapped yaw, speeds and times of the points as they were received."""
    previous = 0.0
    for i in range(n):
        point = points[i]
        lat.rx[i] = point.x
        lat.ry[i] = point.y
        lat.rz[i] = point.z
        lat.rv[i] = point.v
        lat.rt[i] = time_of(points, i, start)
        own = yaw_of(point.qx, point.qy, point.qz, point.qw)
        previous = own if i == 0 else unwrap_step(own, previous)
        lat.ryaw[i] = previous
    lat.source_yaw_end = previous
    lat.source_n = n


@kernel
def _extend(params, lat, n):
    """Append the terminal extension with its times."""
    count = extend(params, lat, n)
    speed = abs(lat.rv[count - 1])
    step = params.traj_resample_dist / speed if speed >= _STANDING else _SHORTEST
    for i in range(n, count):
        lat.rt[i] = lat.rt[i - 1] + step
        lat.ryaw[i] = lat.ryaw[n - 1]
    return count


@kernel
def _is_standing(lat, i, j):
    """Whether the vehicle hardly moves between two neighbours, so that they give no direction."""
    dx = lat.rx[j] - lat.rx[i]
    dy = lat.ry[j] - lat.ry[i]
    length = math.sqrt(dx * dx + dy * dy)
    speed = abs(0.5 * (lat.rv[i] + lat.rv[j]))
    if length < 0.02 and speed < _STANDING:
        return True
    return length < 0.5 * max(speed, _STANDING) * max(lat.rt[j] - lat.rt[i], 0.001)


@kernel
def _fill_yaw(lat, n):
    """Replace each yaw by the direction of the path, where the points around it give one."""
    turn = 0.0 if lat.is_forward else math.pi
    for i in range(n):
        before = max(i - 1, 0)
        after = min(i + 1, n - 1)
        standing = (i > before and _is_standing(lat, before, i)) or (
            i < after and _is_standing(lat, i, after)
        )
        dx = lat.rx[after] - lat.rx[before]
        dy = lat.ry[after] - lat.ry[before]
        if not standing and math.sqrt(dx * dx + dy * dy) >= TOO_CLOSE:
            lat.ryaw[i] = atan2(dy, dx) + turn


@kernel
def _fill_curvature(params, lat, n, reach, out):
    """Fill the curvature [1/m] of each point by a detour over points at equal distances.

    A spline through the distinct points is sampled every ``traj_resample_dist``; the curvature of
    the samples is interpolated at the points. A point that coincides with the one before it gets 0.
    """
    for i in range(n):
        out[i] = 0.0
    distinct = _fill_distinct(lat, n)
    total = lat.rs[n - 1]
    if n < 3 or total < _LENGTH_OF_NOTHING or distinct < 3:
        return
    elimination_factors(lat.arc, lat.gain, distinct)
    second_derivatives(lat.arc, lat.gain, lat.px, lat.mx, distinct)
    second_derivatives(lat.arc, lat.gain, lat.py, lat.my, distinct)
    step = params.traj_resample_dist
    count = _sample(lat, distinct, total, step)
    if count < 3:
        return
    _fill_sampled_curvature(lat, count, reach)
    u = 0
    for i in range(n):
        s = lat.rs[i]
        while u + 1 < distinct and lat.arc[u + 1] <= s + TOO_CLOSE:
            u += 1
        if i == 0 or s - lat.rs[i - 1] > TOO_CLOSE:
            out[i] = _sampled(lat, count, lat.arc[u], step, total)


@kernel
def _fill_distinct(lat, n):
    """Arc length of every point in ``rs``; distinct points in ``px``, ``py``, ``arc``: how many."""
    count = 0
    s = 0.0
    for i in range(n):
        if i > 0:
            dx = lat.rx[i] - lat.rx[i - 1]
            dy = lat.ry[i] - lat.ry[i - 1]
            s += math.sqrt(dx * dx + dy * dy)
        lat.rs[i] = s
        if i == 0 or s - lat.arc[count - 1] > TOO_CLOSE:
            lat.px[count] = lat.rx[i]
            lat.py[count] = lat.ry[i]
            lat.arc[count] = s
            count += 1
    return count


@kernel
def _sample(lat, distinct, total, step):
    """Sample the spline into ``wt`` (x) and ``wv`` (y) from 0 to its end; returns how many."""
    count = 0
    j = 0
    s = 0.0
    room = lat.wt.size - 1
    while s < total and count < room:
        j = interval_from(lat.arc, distinct, j, s)
        lat.wt[count] = spline_value(lat.arc, lat.px, lat.mx, j, s)
        lat.wv[count] = spline_value(lat.arc, lat.py, lat.my, j, s)
        count += 1
        s += step
    if s - step < total - _LENGTH_OF_NOTHING:
        j = interval_from(lat.arc, distinct, j, total)
        lat.wt[count] = spline_value(lat.arc, lat.px, lat.mx, j, total)
        lat.wv[count] = spline_value(lat.arc, lat.py, lat.my, j, total)
        count += 1
    return count


@kernel
def _fill_sampled_curvature(lat, count, reach):
    """Curvature of the samples in ``smooth``; the ends are copied."""
    span = min(reach, (count - 1) // 2)
    last = count - 1 - span
    previous = 0.0
    for i in range(span, last + 1):
        a = i - span
        b = i + span
        x, y = lat.wt, lat.wv
        curvature, is_defined = menger_curvature(x[a], y[a], x[i], y[i], x[b], y[b])
        if is_defined:
            previous = curvature
        lat.smooth[i] = previous
    for i in range(span):
        lat.smooth[i] = lat.smooth[span]
    for i in range(last + 1, count):
        lat.smooth[i] = lat.smooth[last]


@kernel
def _sampled(lat, count, s, step, total):
    """Curvature at arc length ``s``, linear between the samples."""
    i = min(int(s / step), count - 2)
    start = i * step
    end = total if i == count - 2 else start + step
    part = clip((s - start) / (end - start), 0.0, 1.0)
    return lat.smooth[i] + (lat.smooth[i + 1] - lat.smooth[i]) * part


@kernel
def _close(lat, n):
    """End the path: speed zero at the last point, and two duplicates that stand still."""
    lat.rv[n - 1] = 0.0
    for i in range(n, n + 2):
        lat.rx[i] = lat.rx[n - 1]
        lat.ry[i] = lat.ry[n - 1]
        lat.rz[i] = lat.rz[n - 1]
        lat.rv[i] = 0.0
        lat.rt[i] = lat.rt[i - 1] + _TAIL
        lat.ryaw[i] = lat.ryaw[n - 1]
        lat.rk[i] = lat.rk[n - 1]
        lat.rks[i] = lat.rks[n - 1]
    lat.ref_n = n
    lat.is_on_splines = False
    lat.is_timed = True


@kernel
def reference_time(lat, inputs, now):
    """Time [s] on the trajectory's own clock at which the vehicle is now."""
    return clip(now - inputs.trajectory_stamp, lat.rt[0], lat.rt[lat.ref_n + 1])


@kernel
def locate_timed(lat, time):
    """Index of the first point that is due at ``time`` [s] or later, and the place before it."""
    i = 0
    while i < lat.ref_n + 1 and lat.rt[i] < time:
        i += 1
    if i == 0:
        return 0, 0.0
    return i, (time - lat.rt[i - 1]) / (lat.rt[i] - lat.rt[i - 1])


@kernel
def fill_timed_window(params, lat, speed, time):
    """Filter the speeds from the ego's segment on; times count from ``time`` [s]."""
    tau = params.mpc_velocity_time_constant
    limit = params.mpc_acceleration_limit
    end = lat.ref_n + 2
    first = lat.segment
    v = speed
    for i in range(end):
        lat.wt[i] = lat.rt[i] - time
        if i < first or i == end - 1:
            lat.wv[i] = lat.rv[i]
            continue
        if i > first + 1:
            dt = max(lat.rt[i] - lat.rt[i - 1], _SHORTEST)
            a = tau / (tau + dt)
            step = a * v + (1.0 - a) * lat.rv[i] - v
            v += clip(step, -limit * dt, limit * dt)
        lat.wv[i] = v
    lat.segment = 0
    lat.window = end
    lat.nearest_time = 0.0
    lat.prediction_dt = params.mpc_prediction_dt
