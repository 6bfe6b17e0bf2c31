# SPDX-License-Identifier: Apache-2.0
"""Bounds of the quadratic programme: steering angle, and steering rate by curvature and speed."""

import math

from safety_island.kernel.kernel import kernel

_DRY_STEERING_RATE = 100.0  # rad/s, allowed at standstill


@kernel
def _table_value(keys, values, n, x):
    """Linear interpolation; the end values hold outside the table."""
    if x <= keys[0]:
        return values[0]
    if x >= keys[n - 1]:
        return values[n - 1]
    i = 0
    while i < n - 2 and x > keys[i + 1]:
        i += 1
    width = max(keys[i + 1] - keys[i], 1e-5)
    part = min(max((x - keys[i]) / width, 0.0), 1.0)
    return values[i] + part * (values[i + 1] - values[i])


@kernel
def rate_limit(params, v, k):
    """Steering rate limit [rad/s] at speed v [m/s] and curvature k [1/m].

    The firmware looks both up with their sign, so a right curve or reverse always gets the first
    entry; ``symmetric_steer_rate_limits`` takes the absolute values instead.
    """
    if params.symmetric_steer_rate_limits:
        v = abs(v)
        k = abs(k)
    by_curvature = _table_value(
        params.curvature_list_for_steer_rate_lim,
        params.steer_rate_lim_dps_list_by_curvature,
        params.curvature_list_for_steer_rate_lim_size,
        k,
    )
    by_velocity = _table_value(
        params.velocity_list_for_steer_rate_lim,
        params.steer_rate_lim_dps_list_by_velocity,
        params.velocity_list_for_steer_rate_lim_size,
        v,
    )
    return math.radians(min(by_curvature, by_velocity))


@kernel
def fill_bounds(params, lat, qp, speed, horizon):
    """Fill lb, ub (angle) and lbA, ubA (change from step to step; the first from raw_prev)."""
    stopped = abs(speed) < 0.01
    for i in range(horizon):
        qp.lb[i] = -params.max_steer_angle
        qp.ub[i] = params.max_steer_angle
        rate = _DRY_STEERING_RATE if stopped else rate_limit(params, lat.hv[i], lat.hk[i])
        if i == 0:
            qp.lbA[0] = lat.raw_prev - rate * params.ctrl_period
            qp.ubA[0] = lat.raw_prev + rate * params.ctrl_period
        else:
            qp.lbA[i] = -rate * lat.prediction_dt
            qp.ubA[i] = rate * lat.prediction_dt
