"""Exact solve of the MPC's quadratic programme: Cholesky first, the active-set solver when needed.

Fill ``H``, ``f`` and the four bounds of a record with ``QP_COLUMNS`` (see ``qp_records``), call
``factorize``, then ``solve_unconstrained`` or ``solve_constrained``, then ``check_solution``.
"""

from safety_island.control.cholesky import factorize, solve_unconstrained
from safety_island.control.daqp import INFEASIBLE, SOLVED, VIOLATION, solve_dual
from safety_island.control.kernel import entry, kernel
from safety_island.control.qp_check import check_solution
from safety_island.control.qp_records import QP, QP_COLUMNS

__all__ = [
    "MAX_ITERATIONS",
    "QP",
    "QP_COLUMNS",
    "check_solution",
    "factorize",
    "forget_active_set",
    "solve_constrained",
    "solve_problem",
    "solve_unconstrained",
]

MAX_ITERATIONS = 600
"""Working sets that the active-set solver may try; 50 steps took up to 130."""


@kernel
def solve_constrained(q, n, max_iterations):
    """Set ``u`` to the minimiser inside all bounds; ``factorize`` must have been called.

    Returns SOLVED, INFEASIBLE or ITERATION_LIMIT. The active constraints of the last call are the
    first guess of the next; they change the way to the solution, not the solution.
    """
    q.qp_iterations = 0
    if not _bounds_in_order(q, n):
        forget_active_set(q)
        return INFEASIBLE
    solve_unconstrained(q, n)
    if _inside(q, n):
        forget_active_set(q)
        return SOLVED
    for i in range(n):
        q.qp_free[i] = q.u[i]
    return solve_dual(q, n, max_iterations)


@kernel
def forget_active_set(q):
    """Let the next ``solve_constrained`` start without a guess."""
    q.qp_active_count = 0


@kernel
def _bounds_in_order(q, n):
    """Whether no lower bound is above its upper bound (a NaN is not in order either)."""
    for i in range(n):
        if not (q.lb[i] <= q.ub[i] and q.lbA[i] <= q.ubA[i]):
            return False
    return True


@kernel
def _inside(q, n):
    """Whether ``u`` keeps all bounds."""
    before = 0.0
    for i in range(n):
        value = q.u[i]
        change = value - before
        if value > q.ub[i] + VIOLATION or value < q.lb[i] - VIOLATION:
            return False
        if change > q.ubA[i] + VIOLATION or change < q.lbA[i] - VIOLATION:
            return False
        before = value
    return True


@entry(QP, int, int)
def solve_problem(qp, n, max_iterations):
    """Factorize, solve with all constraints and check a problem that stands alone."""
    q = qp[0]
    status = factorize(q, n)
    if status == SOLVED:
        status = solve_constrained(q, n, max_iterations)
    if status == SOLVED:
        status = check_solution(q, n)
    return status
