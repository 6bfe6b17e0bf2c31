# SPDX-License-Identifier: Apache-2.0
"""The path over the MPC's horizon: velocity filter, nearest pose, time stations.

Times count from the first point of the ego's segment; nothing before it is ever read.
"""

import math

from safety_island.control.geometry import clip
from safety_island.control.reference_positions import ensure
from safety_island.control.reference_shape import curvature_at
from safety_island.kernel.kernel import kernel

_EPSILON = 2.220446049250313e-16
_TAIL = 100.0  # seconds that the closing duplicate stands still
_FADED = 1e-6  # m/s
_SLOWEST = 0.1  # m/s, at which the time of a step is taken
_SHORTEST = 1e-4  # s, that a step takes


@kernel
def _filtered_speed(current, target, ds, tau, limit):
    """Velocity filter over one step of ``ds`` [m]: first-order lag, acceleration-limited.

    The lag's weight dt / (tau + dt) and the limit are written with dt = ds / speed multiplied out,
    which leaves one division in the chain from point to point, and nothing that waits for it. A
    speed that has faded away keeps the usual form: what rounding leaves of it is a sign, from which
    the model makes +-1e-4 m/s.
    """
    speed = abs(current)
    gap = target - current
    if speed < _FADED:
        dt = ds / max(speed, _EPSILON)
        a = tau / (tau + dt)
        step = a * current + (1.0 - a) * target - current
        return current + clip(step, -limit * dt, limit * dt)
    below = tau * speed + ds
    if abs(gap) * speed > limit * below:
        return current + math.copysign(limit * ds / speed, gap)
    return current + gap * ds / below if ds > 0.0 else current


@kernel
def _step_to(lat, i):
    """2-D and 3-D length [m] of the step to reference point ``i``."""
    dx = lat.rx[i] - lat.rx[i - 1]
    dy = lat.ry[i] - lat.ry[i - 1]
    dz = lat.rz[i] - lat.rz[i - 1]
    square = dx * dx + dy * dy
    ds = math.sqrt(square)
    return ds, ds if dz == 0.0 else math.sqrt(square + dz * dz)


@kernel
def fill_window(params, lat, speed, ratio, delay, horizon):
    """Filter speed and time as far as the horizon needs; set nearest_time and prediction_dt.

    ``ratio`` is the ego's place in the segment (or -1: it stands at the nearest point). The horizon
    spans at least min_prediction_length [m] and (N - 1) prediction_dt [s]. The path ends with the
    second closing duplicate.
    """
    tau = params.mpc_velocity_time_constant
    limit = params.mpc_acceleration_limit
    end = lat.ref_n + 2 - lat.segment
    nearest = lat.nearest - lat.segment
    total = 0.0
    t_end = math.inf
    # the point before, held in locals: each depends on it, and memory would take its time
    v = speed
    t = 0.0
    lat.wv[0] = v
    lat.wt[0] = t
    lat.window = end
    ready = 0
    for w in range(1, end):
        if lat.segment + w >= ready:
            ready = ensure(lat, lat.segment, lat.segment + w)
        ds = 0.0
        t_before = t
        if w == end - 1:
            v = 0.0
            t += _TAIL
        else:
            ds, length = _step_to(lat, lat.segment + w)
            t += max(length / max(abs(v), _SLOWEST), _SHORTEST)
            if w > 1:
                v = _filtered_speed(v, lat.rv[lat.segment + w], ds, tau, limit)
        lat.wv[w] = v
        lat.wt[w] = t
        if w == 1:
            lat.nearest_time = lat.wt[nearest] if ratio < 0.0 else ratio * t
        if t_end == math.inf and w > nearest:
            total += ds
            if total > params.mpc_min_prediction_length:
                part = (params.mpc_min_prediction_length - (total - ds)) / ds
                target = t_before + (t - t_before) * part
                t_end = _set_horizon(params, lat, target, delay, horizon)
        if t >= t_end:
            lat.window = w + 1
            return
    if t_end == math.inf:
        _set_horizon(params, lat, t - _TAIL, delay, horizon)


@kernel
def _set_horizon(params, lat, target_time, delay, horizon):
    """Set prediction_dt so that the horizon reaches ``target_time``; returns the horizon's end."""
    start = lat.nearest_time + delay
    lat.prediction_dt = max((target_time - start) / (horizon - 1), params.mpc_prediction_dt)
    # one step more than the last station, and what the delay compensation reads lies before it
    return start + horizon * lat.prediction_dt


@kernel
def step_at(lat, w, t):
    """Index of the window's step that holds time ``t``, searched upward from ``w``."""
    while w < lat.window - 2 and t > lat.wt[w + 1]:
        w += 1
    return w


@kernel
def part_of_step(lat, w, t):
    """Place of ``t`` in step w, in [0, 1]."""
    return clip((t - lat.wt[w]) / (lat.wt[w + 1] - lat.wt[w]), 0.0, 1.0)


@kernel
def between(a, b, part):
    """Linear interpolation."""
    return a + (b - a) * part


@kernel
def curvature_between(lat, w, part, reach):
    """Curvature [1/m] at a place in step w of the window."""
    i = lat.segment + w
    return between(curvature_at(lat, i, reach), curvature_at(lat, i + 1, reach), part)


@kernel
def sample_horizon(params, lat, start, horizon):
    """Fill speed and both curvatures at ``start + i prediction_dt``."""
    traj = params.curvature_smoothing_num_traj
    steer = params.curvature_smoothing_num_ref_steer
    w = 0
    for i in range(horizon):
        t = start + i * lat.prediction_dt
        w = step_at(lat, w, t)
        part = part_of_step(lat, w, t)
        lat.hv[i] = between(lat.wv[w], lat.wv[w + 1], part)
        lat.hk[i] = curvature_between(lat, w, part, traj)
        same = steer == traj
        lat.hks[i] = lat.hk[i] if same else curvature_between(lat, w, part, steer)
