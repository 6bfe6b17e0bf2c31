# SPDX-License-Identifier: Apache-2.0
"""Entries that solve and check a quadratic programme outside the tick (OSQP, tests)."""

from safety_island.control.condense import condense
from safety_island.control.lateral_state import LATERAL_STATE
from safety_island.control.qp_check import check_solution
from safety_island.control.qp_records import QP
from safety_island.control.records import PARAMS
from safety_island.control.solver import solve_within_limits, solve_without_limits
from safety_island.kernel.kernel import entry


@entry(QP, int, int, on_demand=True)
def solve_problem(qp, n, max_iterations):
    """Factorize, solve with all constraints and check; returns an MpcStatus."""
    return solve_within_limits(qp[0], n, max_iterations)


@entry(QP, int, on_demand=True)
def solve_problem_without_limits(qp, n):
    """Factorize, solve without constraints and check; returns an MpcStatus."""
    return solve_without_limits(qp[0], n)


@entry(QP, int, on_demand=True)
def check_problem(qp, n):
    """Check the solution ``u`` that something else found; returns an MpcStatus."""
    return check_solution(qp[0], n)


@entry(PARAMS, LATERAL_STATE, QP, on_demand=True)
def condense_problem(params, state, qp):
    """Write down the whole problem of the last tick, which the solver may not have needed.

    ``state`` is the lateral controller's, or a copy: the sums of the condensation are left in it.
    Returns whether the problem is finite.
    """
    return int(condense(params[0], state[0], qp[0], params[0].mpc_prediction_horizon))
