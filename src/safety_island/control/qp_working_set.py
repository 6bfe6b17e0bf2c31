# SPDX-License-Identifier: Apache-2.0
"""The working set: constraints that the active-set solver holds at a bound, and their rows of M."""

from safety_island.control.cholesky import solve_transposed
from safety_island.control.limits import MAX_HORIZON
from safety_island.control.qp_ldl import append_row, forward, remove_row
from safety_island.kernel.kernel import kernel

DEPENDENT = 1e-11
"""A row is a combination of the working set when this part of its squared length is left."""


@kernel
def guess(q, n):
    """Start the working set with the limits met when ``qp_free`` is followed as far as they allow.

    Each step meets one limit at most, so the rows are independent. Returns how many there are.
    """
    for i in range(n):
        q.qp_in_set[i] = 0
        q.qp_in_set[MAX_HORIZON + i] = 0
    for j in range(MAX_HORIZON + 1):
        q.qp_slot[j] = j
    k = 0
    before = 0.0
    for i in range(n):
        high = min(before + q.ubA[i], q.ub[i])
        low = max(before + q.lbA[i], q.lb[i])
        before = max(min(q.qp_free[i], high), low)
        if before == q.qp_free[i]:
            continue
        side = 1 if before < q.qp_free[i] else -1
        is_box = before == (q.ub[i] if side > 0 else q.lb[i])
        constraint = i if is_box else MAX_HORIZON + i
        if append(q, n, k, constraint, side):
            q.qp_in_set[constraint] = 1
            k += 1
    return k


@kernel
def append(q, n, k, constraint, side):
    """Put a constraint behind the k of the working set; return whether it is independent.

    Beside n rows none is, whatever rounding leaves of it: the set has room for one dependent row.
    """
    i = constraint % MAX_HORIZON
    is_rate = constraint >= MAX_HORIZON
    low = q.lbA[i] if is_rate else q.lb[i]
    high = q.ubA[i] if is_rate else q.ub[i]
    start = i - 1 if is_rate and i > 0 else i
    row = q.qp_M[q.qp_slot[k]]
    for c in range(n):
        row[c] = 0.0
    row[i] = 1.0
    value = q.qp_free[i]
    if start < i:
        row[start] = -1.0
        value -= q.qp_free[start]
    solve_transposed(q, row, start, n)
    length = append_row(q, n, k, start)
    q.qp_active[k] = constraint
    q.qp_side[k] = side if low < high else 0
    q.qp_bound[k] = high if side > 0 else low
    q.qp_excess[k] = value - q.qp_bound[k]
    q.qp_start[k] = start
    q.qp_multiplier[k] = 0.0
    forward(q, k, k + 1)
    return k < n and q.qp_D[k] > DEPENDENT * length


@kernel
def remove(q, k, j):
    """Take position j out of the working set of k; return k - 1."""
    slot = q.qp_slot[j]
    q.qp_in_set[q.qp_active[j]] = 0
    remove_row(q, k, j)
    for t in range(j, k - 1):
        q.qp_slot[t] = q.qp_slot[t + 1]
        q.qp_start[t] = q.qp_start[t + 1]
        q.qp_active[t] = q.qp_active[t + 1]
        q.qp_side[t] = q.qp_side[t + 1]
        q.qp_bound[t] = q.qp_bound[t + 1]
        q.qp_excess[t] = q.qp_excess[t + 1]
        q.qp_multiplier[t] = q.qp_multiplier[t + 1]
    q.qp_slot[k - 1] = slot
    forward(q, j, k - 1)
    return k - 1
