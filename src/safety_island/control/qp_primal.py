# SPDX-License-Identifier: Apache-2.0
"""From multipliers of the working set to u, exact to rounding at the active bounds."""

from safety_island.control.cholesky import solve_upper
from safety_island.control.limits import MAX_HORIZON
from safety_island.control.qp_ldl import solve_gram
from safety_island.kernel.kernel import kernel

ACTIVE_ERROR = 1e-13
"""Distance of u from an active bound that is not worth a correction [rad]."""

MAX_CORRECTIONS = 2


@kernel
def primal(q, n, k):
    """Set u = free - H^-1 A' multipliers, and correct what rounding leaves at the active bounds."""
    for i in range(n):
        q.u[i] = q.qp_free[i]
    _shift(q, n, k, q.qp_multiplier)
    for _ in range(MAX_CORRECTIONS):
        if _active_error(q, k) <= ACTIVE_ERROR:
            break
        solve_gram(q, q.qp_target, k)
        _shift(q, n, k, q.qp_target)
        for j in range(k):
            q.qp_multiplier[j] += q.qp_target[j]


@kernel
def _shift(q, n, k, multipliers):
    """Take R^-1 M' multipliers off u."""
    w = q.qp_w
    for i in range(n):
        w[i] = 0.0
    for half in range(k // 2):
        j = 2 * half
        _add_pair(w, n, q, j, multipliers)
    if k % 2 == 1:
        row = q.qp_M[q.qp_slot[k - 1]]
        multiplier = multipliers[k - 1]
        for i in range(n):
            w[i] += multiplier * row[i]
    solve_upper(q, w, n)
    for i in range(n):
        q.u[i] -= w[i]


@kernel
def _add_pair(w, n, q, j, multipliers):
    """Add rows j and j + 1 of the working set, times their multipliers, to w."""
    start = min(q.qp_start[j], q.qp_start[j + 1])
    part = w[start:n]
    a = q.qp_M[q.qp_slot[j]][start:n]
    b = q.qp_M[q.qp_slot[j + 1]][start:n]
    x = multipliers[j]
    y = multipliers[j + 1]
    for i in range(n - start):
        part[i] += x * a[i] + y * b[i]


@kernel
def _active_error(q, k):
    """Set ``qp_target`` to how far u is above each active bound; return the greatest magnitude."""
    worst = 0.0
    for j in range(k):
        constraint = q.qp_active[j]
        i = constraint % MAX_HORIZON
        error = q.u[i] - q.qp_bound[j]
        if constraint > MAX_HORIZON:
            error -= q.u[i - 1]
        q.qp_target[j] = error
        worst = max(worst, abs(error))
    return worst
