# SPDX-License-Identifier: Apache-2.0
"""Model and weights of every step of the MPC's horizon."""

from safety_island.control.vehicle_model import discretize, feed_forward
from safety_island.kernel.kernel import kernel


@kernel
def build_models(params, lat, horizon):
    """Fill the discrete model, the feed-forward and the weights of every step."""
    sign = 1.0 if lat.is_forward else -1.0
    for i in range(horizon):
        v = lat.hv[i]
        k = sign * lat.hk[i]
        discretize(params, v, k, lat.prediction_dt, lat.Ac, lat.A[i], lat.B[i], lat.W[i])
        lat.u_ref[i] = feed_forward(params, v, sign * lat.hks[i])
        _weigh(params, lat, i, v, k, i == horizon - 1)
    _weigh_steering_changes(params, lat, horizon)


@kernel
def _weigh(params, lat, i, v, k, is_last):
    """Fill the weights of step i, from the low-curvature set where the path is nearly straight."""
    low = abs(k) < params.mpc_low_curvature_thresh_curvature
    square = v * v
    if low:
        lateral = params.mpc_low_curvature_weight_lat_error
        heading = params.mpc_low_curvature_weight_heading_error
        heading_square = params.mpc_low_curvature_weight_heading_error_squared_vel
        steer = params.mpc_low_curvature_weight_steering_input
        steer_square = params.mpc_low_curvature_weight_steering_input_squared_vel
        jerk = params.mpc_low_curvature_weight_lat_jerk
    else:
        lateral = params.mpc_weight_lat_error
        heading = params.mpc_weight_heading_error
        heading_square = params.mpc_weight_heading_error_squared_vel
        steer = params.mpc_weight_steering_input
        steer_square = params.mpc_weight_steering_input_squared_vel
        jerk = params.mpc_weight_lat_jerk
    if is_last:
        lateral = params.mpc_weight_terminal_lat_error
        heading = params.mpc_weight_terminal_heading_error
    lat.q_lat[i] = lateral
    lat.q_yaw[i] = heading + square * heading_square
    lat.r0[i] = steer + square * steer_square
    lat.r1[i] = 0.0
    lat.r2[i] = 0.0
    lat.jerk[i] = square * jerk / (lat.prediction_dt * lat.prediction_dt)


@kernel
def _weigh_steering_changes(params, lat, n):
    """Add the weights on steering rate and acceleration, always of the nominal set, to R1."""
    dt = lat.prediction_dt
    period = params.ctrl_period
    rate = params.mpc_weight_steer_rate / (dt * dt)
    for i in range(n - 1):
        lat.r0[i] += rate
        lat.r0[i + 1] += rate
        lat.r1[i] -= rate
    lat.r0[0] += params.mpc_weight_steer_rate / (period * period)
    weight = params.mpc_weight_steer_acc
    a = weight / (dt * dt * dt * dt)
    for i in range(1, n - 1):
        lat.r0[i - 1] += a
        lat.r0[i] += 4.0 * a
        lat.r0[i + 1] += a
        lat.r1[i - 1] -= 2.0 * a
        lat.r1[i] -= 2.0 * a
        lat.r2[i - 1] += a
    c1 = weight / (dt * dt * dt * period)
    c2 = weight / (dt * dt * period * period)
    c4 = weight / (period * period * period * period)
    lat.r0[0] += a + c2 + 2.0 * c1 + c4
    lat.r1[0] -= a + c1
    lat.r0[1] += a
