# SPDX-License-Identifier: Apache-2.0
"""The choice of solver for the quadratic programme; a solution is checked before it is used."""

from safety_island.control.cholesky import factorize, solve_unconstrained
from safety_island.control.qp import MAX_ITERATIONS, solve_constrained
from safety_island.control.qp_check import check_solution, check_unconstrained
from safety_island.control.status import MpcStatus, Solver
from safety_island.kernel.kernel import kernel

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
def solve(params, qp):
    """Solve with the chosen solver of our own and check the solution; an MpcStatus."""
    if params.qp_solver_type == _UNCONSTRAINT_FAST:
        return solve_without_limits(qp, params.mpc_prediction_horizon)
    return solve_within_limits(qp, params.mpc_prediction_horizon, MAX_ITERATIONS)


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
