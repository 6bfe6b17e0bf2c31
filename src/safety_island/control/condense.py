"""The condensed quadratic programme of the MPC: H and f from the models and weights.

The firmware multiplies dense matrices. Here the structure does the work: with the cost to go
``P_j`` (a backward recursion of small matrices) and the response ``Phi_jk B_k`` of state j to input
k, ``H[j, k] = B_j' P_j (Phi_jk B_k)`` for k <= j, which is O(N^2) instead of O(N^3) and equal to
rounding.
"""

import math

from safety_island.control.kernel import kernel
from safety_island.control.vehicle_model import discretize, feed_forward, yaw_row

_STATES = 4


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


@kernel
def advance(a, b, w, u, x, out):
    """out = a x + b u + w."""
    for r in range(_STATES):
        total = b[r] * u + w[r]
        for c in range(_STATES):
            total += a[r, c] * x[c]
        out[r] = total


@kernel
def _roll_out(lat, n):
    """Fill the response of every step without input."""
    advance(lat.A[0], lat.B[0], lat.W[0], 0.0, lat.x0_delayed, lat.free[0])
    for i in range(1, n):
        advance(lat.A[i], lat.B[i], lat.W[i], 0.0, lat.free[i - 1], lat.free[i])


@kernel
def _cost_to_go(lat, f, n, yaw):
    """Backward recursion: row[j] = B_j' P_j for H, and the free response's part of f."""
    cost = lat.cost
    following = lat.cost_next
    g0 = 0.0
    g1 = 0.0
    g2 = 0.0
    g3 = 0.0
    for r in range(_STATES):
        for c in range(_STATES):
            cost[r, c] = 0.0
    for j in range(n - 1, -1, -1):
        if j < n - 1:
            a = lat.A[j + 1]
            _congruence(a, cost, following)
            h0 = a[0, 0] * g0 + a[1, 0] * g1 + a[2, 0] * g2 + a[3, 0] * g3
            h1 = a[0, 1] * g0 + a[1, 1] * g1 + a[2, 1] * g2 + a[3, 1] * g3
            h2 = a[0, 2] * g0 + a[1, 2] * g1 + a[2, 2] * g2 + a[3, 2] * g3
            h3 = a[0, 3] * g0 + a[1, 3] * g1 + a[2, 3] * g2 + a[3, 3] * g3
            g0 = h0
            g1 = h1
            g2 = h2
            g3 = h3
        cost[0, 0] += lat.q_lat[j]
        cost[yaw, yaw] += lat.q_yaw[j]
        g0 += lat.q_lat[j] * lat.free[j, 0]
        pull = lat.q_yaw[j] * lat.free[j, yaw]
        if yaw == 1:
            g1 += pull
        else:
            g2 += pull
        b = lat.B[j]
        for c in range(_STATES):
            row = 0.0
            for r in range(_STATES):
                row += b[r] * cost[r, c]
            lat.row[j, c] = row
        f[j] = b[0] * g0 + b[1] * g1 + b[2] * g2 + b[3] * g3


@kernel
def _congruence(a, cost, work):
    """cost = a' cost a, symmetric."""
    for r in range(_STATES):
        for c in range(_STATES):
            total = 0.0
            for m in range(_STATES):
                total += cost[r, m] * a[m, c]
            work[r, c] = total
    for r in range(_STATES):
        for c in range(r, _STATES):
            total = 0.0
            for m in range(_STATES):
                total += a[m, r] * work[m, c]
            cost[r, c] = total
            cost[c, r] = total


@kernel
def _fill_hessian(lat, hessian, n):
    """Lower triangle of (CB)'Q(CB), row by row, while the input responses move one step on."""
    z0 = lat.columns[0]
    z1 = lat.columns[1]
    z2 = lat.columns[2]
    z3 = lat.columns[3]
    for j in range(n):
        a = lat.A[j]
        a00, a01, a02, a03 = a[0, 0], a[0, 1], a[0, 2], a[0, 3]
        a10, a11, a12, a13 = a[1, 0], a[1, 1], a[1, 2], a[1, 3]
        a20, a21, a22, a23 = a[2, 0], a[2, 1], a[2, 2], a[2, 3]
        a30, a31, a32, a33 = a[3, 0], a[3, 1], a[3, 2], a[3, 3]
        p0, p1, p2, p3 = lat.row[j, 0], lat.row[j, 1], lat.row[j, 2], lat.row[j, 3]
        target = hessian[j]
        for k in range(j):
            x0 = z0[k]
            x1 = z1[k]
            x2 = z2[k]
            x3 = z3[k]
            y0 = a00 * x0 + a01 * x1 + a02 * x2 + a03 * x3
            y1 = a10 * x0 + a11 * x1 + a12 * x2 + a13 * x3
            y2 = a20 * x0 + a21 * x1 + a22 * x2 + a23 * x3
            y3 = a30 * x0 + a31 * x1 + a32 * x2 + a33 * x3
            z0[k] = y0
            z1[k] = y1
            z2[k] = y2
            z3[k] = y3
            target[k] = p0 * y0 + p1 * y1 + p2 * y2 + p3 * y3
        b = lat.B[j]
        z0[j] = b[0]
        z1[j] = b[1]
        z2[j] = b[2]
        z3[j] = b[3]
        target[j] = p0 * b[0] + p1 * b[1] + p2 * b[2] + p3 * b[3]


@kernel
def _add_input_weights(lat, hessian, f, n):
    """Add R1 and R2 to H and the feed-forward's part to f; mirror H."""
    for i in range(n):
        hessian[i, i] += lat.r0[i]
        pull = lat.r0[i] * lat.u_ref[i]
        if i + 1 < n:
            hessian[i + 1, i] += lat.r1[i] - lat.jerk[i]
            hessian[i, i] += lat.jerk[i]
            hessian[i + 1, i + 1] += lat.jerk[i]
            pull += lat.r1[i] * lat.u_ref[i + 1]
        if i + 2 < n:
            hessian[i + 2, i] += lat.r2[i]
            pull += lat.r2[i] * lat.u_ref[i + 2]
        if i > 0:
            pull += lat.r1[i - 1] * lat.u_ref[i - 1]
        if i > 1:
            pull += lat.r2[i - 2] * lat.u_ref[i - 2]
        f[i] -= pull
    for i in range(n):
        for k in range(i):
            hessian[k, i] = hessian[i, k]


@kernel
def is_finite_problem(hessian, f, n):
    """Whether every entry that the solver reads is finite, and their sum too."""
    total = 0.0
    for i in range(n):
        total += abs(f[i])
        for k in range(i + 1):
            total += abs(hessian[i, k])
    return math.isfinite(total)


@kernel
def condense(params, lat, hessian, f, horizon):
    """Fill H and f of ``min 1/2 u'Hu + f'u`` over the steering inputs of the horizon."""
    yaw = yaw_row(params)
    _roll_out(lat, horizon)
    _cost_to_go(lat, f, horizon, yaw)
    _fill_hessian(lat, hessian, horizon)
    _add_input_weights(lat, hessian, f, horizon)
