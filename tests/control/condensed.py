# SPDX-License-Identifier: Apache-2.0
"""The condensed problem of a tick, which the controller makes only where a limit is active.

It is the oracle of the recursion: the same problem with a matrix, solved by other means.
"""

from __future__ import annotations

from typing import Any

from safety_island.control.condense import condense
from safety_island.control.lateral_state import LATERAL_STATE
from safety_island.control.qp import MAX_ITERATIONS
from safety_island.control.qp_records import QP
from safety_island.control.records import PARAMS
from safety_island.control.solver import solve, solve_within_limits, solve_without_limits
from safety_island.control.status import MpcStatus, Solver
from safety_island.kernel.kernel import entry
from safety_island.kernel.records import Records

INVALID_MATRIX = int(MpcStatus.INVALID_MATRIX)
SOLVED = int(MpcStatus.SOLVED)
UNCONSTRAINT_FAST = int(Solver.UNCONSTRAINT_FAST)


@entry(PARAMS, LATERAL_STATE, QP)
def condense_problem(params: Any, state: Any, qp: Any) -> Any:
    """Fill H and f from the models and the cost; SOLVED or INVALID_MATRIX."""
    is_finite = condense(params[0], state[0], qp[0], params[0].mpc_prediction_horizon)
    return SOLVED if is_finite else INVALID_MATRIX


@entry(PARAMS, LATERAL_STATE, QP)
def solve_condensed(params: Any, state: Any, qp: Any) -> Any:
    """Solve with the chosen solver by the condensed problem alone."""
    n = params[0].mpc_prediction_horizon
    if not condense(params[0], state[0], qp[0], n):
        return INVALID_MATRIX
    if params[0].qp_solver_type == UNCONSTRAINT_FAST:
        return solve_without_limits(qp[0], n)
    return solve_within_limits(qp[0], n, MAX_ITERATIONS)


@entry(PARAMS, LATERAL_STATE, QP)
def solve_as_the_controller(params: Any, state: Any, qp: Any) -> Any:
    """Solve as a tick does."""
    return solve(params[0], state[0], qp[0])


def condensed(params: Records, state: Records, qp: Records) -> Any:
    """The problem of the last tick as a QP record, with its H, f and solution."""
    problem = qp.copy()
    condense_problem.prepare()
    condense_problem.call(params, state, problem)
    problem[0].u = qp[0].u
    return problem[0]
