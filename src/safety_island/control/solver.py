# SPDX-License-Identifier: Apache-2.0
"""The choice of solver for the quadratic programme; a solution is checked before it is used.

In most ticks no limit is active. Then the recursion finds the optimum without a matrix, and its
gradient, which one more sweep over the models gives, proves it. In every other case, whatever the
reason, the condensed problem decides: it alone says that there is no solution, and why.
"""

from safety_island.control.cholesky import factorize, solve_unconstrained
from safety_island.control.condense import condense
from safety_island.control.daqp import VIOLATION
from safety_island.control.gradient import fill_gradient
from safety_island.control.qp import MAX_ITERATIONS, solve_constrained
from safety_island.control.qp_check import (
    check_solution,
    check_unconstrained,
    is_stationary,
    violation,
)
from safety_island.control.recursion import solve_recursively
from safety_island.control.status import MpcStatus, Solver
from safety_island.kernel.kernel import kernel

_INVALID_MATRIX = int(MpcStatus.INVALID_MATRIX)
_SOLVED = int(MpcStatus.SOLVED)
_UNCONSTRAINT_FAST = int(Solver.UNCONSTRAINT_FAST)


@kernel
def solve_without_limits(qp, n):
    """Solve by Cholesky and ignore every limit, as the firmware does."""
    status = factorize(qp, n)
    if status != _SOLVED:
        return status
    solve_unconstrained(qp, n)
    qp.qp_iterations = 0
    qp.qp_active_count = 0
    return check_unconstrained(qp, n)


@kernel
def solve_within_limits(qp, n, max_iterations):
    """Solve exactly with every limit."""
    status = factorize(qp, n)
    if status == _SOLVED:
        status = solve_constrained(qp, n, max_iterations)
    return check_solution(qp, n) if status == _SOLVED else status


@kernel
def _is_free_optimum(params, lat, qp, n):
    """Set ``u`` to the optimum without limits; whether that is proved, and limits are kept."""
    qp.qp_iterations = 0
    qp.qp_active_count = 0
    qp.qp_violation = 0.0
    if not solve_recursively(params, lat, qp.u, n):
        return False
    if params.qp_solver_type != _UNCONSTRAINT_FAST:
        qp.qp_violation = violation(qp, n)
        if not qp.qp_violation <= VIOLATION:
            return False
    return is_stationary(qp, n, fill_gradient(params, lat, qp.u, n, qp.qp_v))


@kernel
def solve(params, lat, qp):
    """Solve with the chosen solver of our own and check the solution; an MpcStatus."""
    n = params.mpc_prediction_horizon
    if _is_free_optimum(params, lat, qp, n):
        return _SOLVED
    if not condense(params, lat, qp, n):
        return _INVALID_MATRIX
    if params.qp_solver_type == _UNCONSTRAINT_FAST:
        return solve_without_limits(qp, n)
    return solve_within_limits(qp, n, MAX_ITERATIONS)


@kernel
def tell_solver(params, qp, trace, status):
    """Write how the solver ended into the trace."""
    trace.solver_status = status
    trace.solver_iterations = qp.qp_iterations
    trace.active_constraints = qp.qp_active_count
    trace.residual = qp.qp_residual
    keeps_limits = status == _SOLVED and params.qp_solver_type != _UNCONSTRAINT_FAST
    trace.rate_limited = keeps_limits and _touches_rate(qp)


@kernel
def _touches_rate(qp):
    """Whether the first step of the solution stands at its steering-rate bound."""
    u = qp.u[0]
    return u >= qp.ubA[0] - 1e-9 or u <= qp.lbA[0] + 1e-9
