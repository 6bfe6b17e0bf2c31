# SPDX-License-Identifier: Apache-2.0
"""A dual active-set solver for the quadratic programme of the MPC.

After D. Arnstroem, A. Bemporad and D. Axehill, "A dual active-set solver for embedded quadratic
programming using recursive LDL' updates", IEEE Transactions on Automatic Control 67 (2022). With
H = R'R and w = R (u - free) the problem is the shortest w with M w <= d, M = A R^-1. A row of A
touches one or two neighbours of u, so a row of M costs one short triangular solve, made only for
constraints that enter the working set. Multipliers are positive on an upper bound, negative on a
lower one, free where both bounds are equal.
"""

import math

from safety_island.control.limits import MAX_HORIZON
from safety_island.control.qp_ldl import back_substitute, solve_targets
from safety_island.control.qp_primal import primal
from safety_island.control.qp_working_set import append, guess, remove
from safety_island.control.status import MpcStatus
from safety_island.kernel.kernel import kernel

SOLVED = int(MpcStatus.SOLVED)
INFEASIBLE = int(MpcStatus.INFEASIBLE)
ITERATION_LIMIT = int(MpcStatus.ITERATION_LIMIT)

VIOLATION = 1e-11
"""A bound counts as kept when it is exceeded by no more than this [rad]."""

ROUNDING = 1e-13
"""A multiplier of the wrong sign counts as zero below this part of the greatest one."""


@kernel
def solve_dual(q, n, max_iterations):
    """Find the constrained minimiser from ``qp_free`` and the factor of H.

    Keeps nothing from one call to the next: the same problem gives the same bytes. Sets ``u`` and
    returns SOLVED, INFEASIBLE or ITERATION_LIMIT.
    """
    k = guess(q, n)
    best = -1.0
    stalled = False
    status = ITERATION_LIMIT
    while q.qp_iterations < max_iterations:
        q.qp_iterations += 1
        solve_targets(q, k)
        blocking = _step_to_targets(q, k, stalled)
        if blocking >= 0:
            k = remove(q, k, blocking)
            continue
        primal(q, n, k)
        value = _dual_value(q, k)
        stalled = stalled or value <= best
        best = max(best, value)
        entering = _most_violated(q, n, stalled)
        if entering == 0:
            status = SOLVED
            break
        k = _enter(q, n, k, entering)
        if k < 0:
            k = 0
            status = INFEASIBLE
            break
    q.qp_active_count = k if status == SOLVED else 0
    return status


@kernel
def _step_to_targets(q, k, stalled):
    """Move the multipliers to their targets, or as far as their signs allow.

    Returns the position that stops the step, -1 for a whole step.
    """
    greatest = 0.0
    for j in range(k):
        greatest = max(greatest, abs(q.qp_target[j]))
    fraction = 1.0
    worst = 0.0
    blocking = -1
    for j in range(k):
        target = q.qp_side[j] * q.qp_target[j]
        if target < -ROUNDING * greatest:
            now = max(q.qp_side[j] * q.qp_multiplier[j], 0.0)
            part = now / (now - target)
            if part < fraction or (part == fraction and target < worst and not stalled):
                fraction = part
                worst = target
                blocking = j
    for j in range(k):
        q.qp_multiplier[j] += fraction * (q.qp_target[j] - q.qp_multiplier[j])
    return blocking


@kernel
def _dual_value(q, k):
    """Twice the dual objective of the present working set; grows from one to the next."""
    value = 0.0
    for j in range(k):
        value += q.qp_y[j] * q.qp_y[j] / q.qp_D[j]
    return value


@kernel
def _most_violated(q, n, stalled):
    """Constraint + 1 that is violated most, negative for its lower bound, 0 for none.

    After a stall the first one is taken: with the least index on both ends no cycle is possible.
    """
    worst = VIOLATION
    entering = 0
    before = 0.0
    for i in range(n):
        value = q.u[i]
        if q.qp_in_set[i] == 0:
            if value - q.ub[i] > worst:
                worst = value - q.ub[i]
                entering = i + 1
            if q.lb[i] - value > worst:
                worst = q.lb[i] - value
                entering = -(i + 1)
        if q.qp_in_set[MAX_HORIZON + i] == 0:
            change = value - before
            if change - q.ubA[i] > worst:
                worst = change - q.ubA[i]
                entering = MAX_HORIZON + i + 1
            if q.lbA[i] - change > worst:
                worst = q.lbA[i] - change
                entering = -(MAX_HORIZON + i + 1)
        before = value
        if stalled and entering != 0:
            break
    return entering


@kernel
def _enter(q, n, k, entering):
    """Add a violated constraint; one that depends on the set pushes another out.

    Returns the new size of the set, -1 when the bounds contradict each other.
    """
    side = 1 if entering > 0 else -1
    constraint = abs(entering) - 1
    independent = append(q, n, k, constraint, side)
    q.qp_in_set[constraint] = 1
    if independent:
        return k + 1
    leaving = _step_along_null(q, k, side)
    if leaving < 0:
        return -1
    return remove(q, k + 1, leaving)


@kernel
def _step_along_null(q, k, side):
    """Raise the multiplier of the dependent row k until another one reaches zero.

    The multipliers move along the null vector of the Gram matrix: the dual objective grows without
    bound unless a sign stops it. Returns the position that does, -1 for none.
    """
    null = q.qp_target
    for j in range(k):
        null[j] = 0.0
    null[k] = float(side)
    back_substitute(q, null, k + 1)
    greatest = 0.0
    for j in range(k):
        greatest = max(greatest, abs(null[j]))
    step = math.inf
    leaving = -1
    for j in range(k):
        slope = q.qp_side[j] * null[j]
        if slope < -ROUNDING * greatest:
            length = max(q.qp_side[j] * q.qp_multiplier[j], 0.0) / -slope
            if length < step:
                step = length
                leaving = j
    if leaving >= 0:
        for j in range(k + 1):
            q.qp_multiplier[j] += step * null[j]
    return leaving
