# SPDX-License-Identifier: Apache-2.0
"""The recursion of ``recursion`` for a model of four states, any of them coupled.

The yaw error is state 2. ``value`` is P, of z = (x, u, v); ``value_slope`` is p.
"""

from safety_island.control.vehicle_model import advance_dynamic
from safety_island.kernel.kernel import kernel

_X = 4  # states
_U = 4  # place of u in z
_V = 5
_Z = 6


@kernel
def fill_feedback(lat, n):
    """Fill ``pivot`` = h_uu and ``feedback`` = (h_u, h_ua, h_ub, h_ux) / h_uu of every step.

    Returns False at a pivot that is not positive.
    """
    cost, slope = lat.value, lat.value_slope
    for r in range(_Z):
        slope[r] = 0.0
        for c in range(_Z):
            cost[r, c] = 0.0
    for j in range(n - 1, -1, -1):
        b, w = lat.B[j], lat.W[j]
        cost[0, 0] += lat.q_lat[j]
        cost[2, 2] += lat.q_yaw[j]
        for r in range(_Z):
            for c in range(_X):
                slope[r] += cost[r, c] * w[c]
        _fill_row(lat, j)
        row = lat.value_row
        pivot = cost[_U, _U] + lat.r0[j]
        linear = slope[_U] - lat.pull[j]
        for r in range(_X):
            pivot += b[r] * (row[r] + cost[r, _U])
            linear += b[r] * slope[r]
        if not pivot > 0.0:
            return False
        _step_back(lat, j)
        _eliminate(lat, j, pivot, linear)
    return True


@kernel
def _fill_row(lat, j):
    """Set ``value_row`` to B'P_x + P_u, by x_(j+1); its last two places to h_ua and h_ub."""
    cost, row, b = lat.value, lat.value_row, lat.B[j]
    for c in range(_Z):
        row[c] = cost[_U, c]
        for r in range(_X):
            row[c] += b[r] * cost[r, c]
    row[_U] = row[_V] + lat.r1[j]
    row[_V] = lat.r2[j]


@kernel
def _step_back(lat, j):
    """Express P, p and the row by x_j and by the inputs before step j: v takes the place of u."""
    cost, slope, row, work, a = lat.value, lat.value_slope, lat.value_row, lat.value_work, lat.A[j]
    for r in range(_Z):
        for c in range(_X):
            work[r, c] = 0.0
            for m in range(_X):
                work[r, c] += cost[r, m] * a[m, c]
    for c in range(_X):
        work[_U, c] = row[c]  # the row of u is needed no more; its place holds the one to be turned
    for r in range(_X):
        row[r] = 0.0
        cost[_U, r] = cost[r, _U] = work[_V, r]
        cost[_V, r] = cost[r, _V] = 0.0
        for m in range(_X):
            row[r] += work[_U, m] * a[m, r]
        for c in range(_X):
            cost[r, c] = 0.0
            for m in range(_X):
                cost[r, c] += a[m, r] * work[m, c]
    cost[_U, _U] = cost[_V, _V]
    cost[_U, _V] = cost[_V, _U] = cost[_V, _V] = 0.0
    for c in range(_X):
        work[0, c] = slope[c]
    for r in range(_X):
        slope[r] = 0.0
        for m in range(_X):
            slope[r] += a[m, r] * work[0, m]
    slope[_U] = slope[_V]
    slope[_V] = 0.0


@kernel
def _eliminate(lat, j, pivot, linear):
    """Write the feedback of step j, and take off P and p what the best u_j saves."""
    row = lat.value_row
    inverse = 1.0 / pivot
    lat.pivot[j] = pivot
    feedback = lat.feedback[j]
    feedback[0] = linear * inverse
    feedback[1] = row[_U] * inverse
    feedback[2] = row[_V] * inverse
    for r in range(_X):
        feedback[3 + r] = row[r] * inverse
    for r in range(_Z):
        gain = row[r] * inverse
        lat.value_slope[r] -= gain * linear
        for c in range(_Z):
            lat.value[r, c] -= gain * row[c]


@kernel
def roll_out(lat, u, n):
    """Fill ``u`` (n,) by the feedback, from the state in which the horizon begins."""
    x = lat.x0_delayed
    x0, x1, x2, x3 = x[0], x[1], x[2], x[3]
    before, second = 0.0, 0.0
    for j in range(n):
        row, a, b, w = lat.feedback[j], lat.A[j], lat.B[j], lat.W[j]
        known = row[0] + row[1] * before + row[2] * second
        value = -(known + row[3] * x0 + row[4] * x1 + row[5] * x2 + row[6] * x3)
        u[j] = value
        x0, x1, x2, x3 = advance_dynamic(a, b, w, value, x0, x1, x2, x3)
        second = before
        before = value
