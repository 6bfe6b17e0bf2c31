# SPDX-License-Identifier: Apache-2.0
"""One tick of the lateral MPC: from the reference path to a steering angle."""

import math

import numpy as np

from safety_island.control.cost import fill_cost
from safety_island.control.filters import butterworth
from safety_island.control.geometry import clip, normalize_angle, yaw_of
from safety_island.control.horizon_models import build_models
from safety_island.control.prediction import (
    between,
    curvature_between,
    fill_window,
    part_of_step,
    sample_horizon,
    step_at,
)
from safety_island.control.reference_shape import (
    ensure_curvature,
    ensure_yaw,
    nearest_on_reference,
    segment_on_reference,
    yaw_at,
)
from safety_island.control.reference_temporal import (
    fill_timed_window,
    locate_timed,
    reference_time,
)
from safety_island.control.status import MpcStatus, VehicleModel
from safety_island.control.steering_predictor import predict_steering, store_command
from safety_island.control.steering_rate_limit import fill_bounds
from safety_island.control.vehicle_model import advance, discretize
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.trigonometric import cos, sin

_SOLVED = int(MpcStatus.SOLVED)
_NO_REFERENCE = int(MpcStatus.NO_REFERENCE)
_TOO_FAR = int(MpcStatus.TOO_FAR)
_YAW_ERROR = int(MpcStatus.YAW_ERROR_TOO_LARGE)
_KINEMATICS = int(VehicleModel.KINEMATICS)
_DYNAMICS = int(VehicleModel.DYNAMICS)


@kernel
def locate(params, inputs, lat, trace):
    """Find the ego on the reference; returns the status and its place in the segment.

    The place is -1 where the segment has no length: the nearest point counts.
    """
    yaw = yaw_of(inputs.qx, inputs.qy, inputs.qz, inputs.qw)
    lat.nearest = nearest_on_reference(
        lat,
        inputs.x,
        inputs.y,
        yaw,
        params.ego_nearest_dist_threshold,
        params.ego_nearest_yaw_threshold,
    )
    lat.segment = segment_on_reference(lat, lat.nearest, inputs.x, inputs.y)
    a = lat.segment
    ensure_yaw(lat, a, a + 1)
    dx = lat.rx[a + 1] - lat.rx[a]
    dy = lat.ry[a + 1] - lat.ry[a]
    length_squared = dx * dx + dy * dy
    if length_squared < 1e-10:
        ratio = -1.0
        x = lat.rx[lat.nearest]
        y = lat.ry[lat.nearest]
        path_yaw = yaw_at(lat, lat.nearest)
    else:
        along = dx * (inputs.x - lat.rx[a]) + dy * (inputs.y - lat.ry[a])
        ratio = clip(along / length_squared, 0.0, 1.0)
        x = lat.rx[a] + ratio * dx
        y = lat.ry[a] + ratio * dy
        first = yaw_at(lat, a)
        path_yaw = normalize_angle(first + ratio * normalize_angle(yaw_at(lat, a + 1) - first))
    return _set_errors(params, inputs, lat, trace, x, y, yaw, path_yaw), ratio


@kernel
def _locate_by_time(params, inputs, lat, trace, time):
    """Set the errors against where the vehicle should be at ``time`` [s]; returns the status."""
    yaw = yaw_of(inputs.qx, inputs.qy, inputs.qz, inputs.qw)
    i, part = locate_timed(lat, time)
    a = max(i - 1, 0)
    x = between(lat.rx[a], lat.rx[i], part)
    y = between(lat.ry[a], lat.ry[i], part)
    path_yaw = normalize_angle(lat.ryaw[a] + part * normalize_angle(lat.ryaw[i] - lat.ryaw[a]))
    status = _set_errors(params, inputs, lat, trace, x, y, yaw, path_yaw)
    trace.nearest_idx = i
    return status


@kernel
def _set_errors(params, inputs, lat, trace, x, y, yaw, path_yaw):
    """Set the errors against the reference point (x, y) [m]; a status when they are too large."""
    ex = inputs.x - x
    ey = inputs.y - y
    trace.nearest_idx = lat.nearest
    trace.lateral_error = -sin(path_yaw) * ex + cos(path_yaw) * ey
    trace.yaw_error = normalize_angle(yaw - path_yaw)
    if not params.enable_deviation_checks:
        return _SOLVED
    if math.sqrt(ex * ex + ey * ey) > params.admissible_position_error:
        return _TOO_FAR
    if abs(trace.yaw_error) > params.admissible_yaw_error_rad:
        return _YAW_ERROR
    return _SOLVED


@kernel
def _fill_initial_state(params, lat, trace):
    """Fill x0 from the errors and the measured (or predicted) steering angle."""
    x0 = lat.x0
    lateral = trace.lateral_error
    yaw = trace.yaw_error
    if params.vehicle_model_type == _DYNAMICS:
        period = params.ctrl_period
        cutoff = params.error_deriv_lpf_cutoff_hz
        lateral_rate = (lateral - lat.lateral_error_prev) / period
        yaw_rate = (yaw - lat.yaw_error_prev) / period
        lat.lateral_error_prev = lateral
        lat.yaw_error_prev = yaw
        x0[0] = lateral
        x0[1] = butterworth(lat.lateral_filter, lateral_rate, cutoff, period)
        x0[2] = yaw
        x0[3] = butterworth(lat.yaw_filter, yaw_rate, cutoff, period)
        return
    x0[0] = lateral
    x0[1] = yaw
    x0[3] = 0.0
    if params.vehicle_model_type == _KINEMATICS:
        x0[2] = lat.predicted if params.use_steer_prediction else lat.measured
    else:
        x0[2] = 0.0


@kernel
def _compensate_delay(params, lat):
    """Lead x0 through the commands that are still on their way: x0_delayed."""
    sign = 1.0 if lat.is_forward else -1.0
    x = lat.x0
    w = 0
    for r in range(4):
        lat.x0_delayed[r] = x[r]
    for i in range(lat.delay_n):
        t = lat.nearest_time + i * params.ctrl_period
        w = step_at(lat, w, t)
        part = part_of_step(lat, w, t)
        v = between(lat.wv[w], lat.wv[w + 1], part)
        k = sign * curvature_between(lat, w, part, params.curvature_smoothing_num_traj)
        discretize(params, v, k, params.ctrl_period, lat.Ac, lat.A[0], lat.B[0], lat.W[0])
        advance(lat.A[0], lat.B[0], lat.W[0], lat.delay[i], lat.x0_delayed, lat.x_next)
        for r in range(4):
            lat.x0_delayed[r] = lat.x_next[r]


@kernel
def prepare_mpc(params, inputs, lat, qp, trace, now):
    """Set up this tick's problem: models, cost, bounds; SOLVED: it is ready to be solved."""
    lat.prediction_dt = 0.0
    trace.predicted_steer = predict_steering(lat, now, params.vehicle_model_steer_tau)
    if lat.ref_n == 0:
        return _NO_REFERENCE
    status, ratio = locate(params, inputs, lat, trace)
    time = 0.0
    if lat.is_timed:  # the place in the segment still decides from where on speeds are filtered
        time = reference_time(lat, inputs, now)
        status = _locate_by_time(params, inputs, lat, trace, time)
    if status != _SOLVED:
        return status
    _fill_initial_state(params, lat, trace)
    horizon = params.mpc_prediction_horizon
    delay = lat.delay_n * params.ctrl_period
    if lat.is_timed:
        fill_timed_window(params, lat, inputs.vx, time)
    else:
        fill_window(params, lat, inputs.vx, ratio, delay, horizon)
        reach = max(params.curvature_smoothing_num_traj, params.curvature_smoothing_num_ref_steer)
        ensure_curvature(lat, lat.segment, lat.segment + lat.window, reach)
    trace.nearest_time = lat.nearest_time
    trace.prediction_dt = lat.prediction_dt
    _compensate_delay(params, lat)
    sample_horizon(params, lat, lat.nearest_time + delay, horizon)
    build_models(params, lat, horizon)
    fill_cost(params, lat, horizon)
    fill_bounds(params, lat, qp, inputs.vx, horizon)
    return _SOLVED


@kernel
def finish_mpc(params, lat, qp, trace, now):
    """Turn the raw solution into the angle and rate of the command; returns both as float32."""
    raw = qp.u[0]
    limit = params.max_steer_angle
    limited = clip(raw, -limit, limit)
    trace.angle_limited = limited != raw
    angle = butterworth(
        lat.steering_filter, limited, params.steering_lpf_cutoff_hz, params.ctrl_period
    )
    if params.vehicle_model_type == _KINEMATICS:
        advance(lat.A[0], lat.B[0], lat.W[0], raw, lat.x0_delayed, lat.x_next)
        rate = (lat.x_next[2] - lat.x0_delayed[2]) / lat.prediction_dt
    else:
        rate = (angle - lat.measured) / lat.prediction_dt
    lat.raw_pprev = lat.raw_prev
    lat.raw_prev = raw
    command = np.float32(angle)
    for i in range(1, lat.delay_n):
        lat.delay[i - 1] = lat.delay[i]
    if lat.delay_n > 0:
        lat.delay[lat.delay_n - 1] = command
    store_command(lat, command, now, lat.delay_n * params.ctrl_period)
    for i in range(params.mpc_prediction_horizon):
        trace.u[i] = qp.u[i]
    return command, np.float32(rate)
