# SPDX-License-Identifier: Apache-2.0
"""Exact solve of the MPC's quadratic programme: Cholesky first, the active-set solver when needed.

Fill ``H``, ``f`` and the four bounds of a record with ``QP_COLUMNS`` (see ``qp_records``), call
``factorize``, then ``solve_unconstrained`` or ``solve_constrained``, then ``check_solution``.
"""

from safety_island.control.cholesky import factorize, solve_unconstrained
from safety_island.control.daqp import INFEASIBLE, SOLVED, VIOLATION, solve_dual
from safety_island.control.qp_check import check_solution, check_unconstrained, violation
from safety_island.control.qp_records import QP, QP_COLUMNS
from safety_island.kernel.kernel import kernel

__all__ = [
    "MAX_ITERATIONS",
    "QP",
    "QP_COLUMNS",
    "check_solution",
    "check_unconstrained",
    "factorize",
    "solve_constrained",
    "solve_unconstrained",
]

MAX_ITERATIONS = 600
"""Working sets that the active-set solver may try; 50 steps took up to 130."""


@kernel
def solve_constrained(q, n, max_iterations):
    """Set ``u`` to the minimiser inside all bounds; ``factorize`` must have been called.

    Returns SOLVED, INFEASIBLE or ITERATION_LIMIT.
    """
    q.qp_iterations = 0
    q.qp_active_count = 0
    if not _feasible(q, n):
        return INFEASIBLE
    solve_unconstrained(q, n)
    if violation(q, n) <= VIOLATION:
        return SOLVED
    for i in range(n):
        q.qp_free[i] = q.u[i]
    return solve_dual(q, n, max_iterations)


@kernel
def _feasible(q, n):
    """Whether a u inside all bounds exists: the interval that u_i can reach, step by step.

    Exact, because each row touches one or two neighbours. NaN in a bound is infeasible too.
    """
    low = 0.0
    high = 0.0
    feasible = True
    for i in range(n):
        feasible = feasible and q.lb[i] <= q.ub[i] and q.lbA[i] <= q.ubA[i]
        low = max(low + q.lbA[i], q.lb[i])
        high = min(high + q.ubA[i], q.ub[i])
        feasible = feasible and low <= high + VIOLATION
    return feasible
