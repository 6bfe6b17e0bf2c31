# SPDX-License-Identifier: Apache-2.0
"""Cost to go and Hessian of the condensed problem for a model of four states, any of them coupled.

The yaw error is state 2. ``condense`` says what is computed here.
"""

from safety_island.kernel.kernel import kernel

_STATES = 4


@kernel
def cost_to_go(lat, n):
    """Backward recursion: row[j] = B_j' P_j."""
    cost = lat.cost
    following = lat.cost_next
    for r in range(_STATES):
        for c in range(_STATES):
            cost[r, c] = 0.0
    for j in range(n - 1, -1, -1):
        if j < n - 1:
            _congruence(lat.A[j + 1], cost, following)
        cost[0, 0] += lat.q_lat[j]
        cost[2, 2] += lat.q_yaw[j]
        b = lat.B[j]
        for c in range(_STATES):
            row = 0.0
            for r in range(_STATES):
                row += b[r] * cost[r, c]
            lat.row[j, c] = row


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
def fill_hessian(lat, hessian, n):
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
