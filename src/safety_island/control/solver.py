"""The choice of solver for the MPC's quadratic programme."""

import math

from safety_island.control.cholesky import factorize, solve_unconstrained
from safety_island.control.kernel import kernel
from safety_island.control.status import MpcStatus

_SOLVED = int(MpcStatus.SOLVED)
_NOT_FINITE = int(MpcStatus.SOLUTION_NOT_FINITE)


@kernel
def solve_without_limits(qp, n):
    """Solve by Cholesky and ignore every limit, as the firmware's ``unconstraint_fast``."""
    status = factorize(qp, n)
    if status != _SOLVED:
        return status
    solve_unconstrained(qp, n)
    for i in range(n):
        if not math.isfinite(qp.u[i]):
            return _NOT_FINITE
    return _SOLVED


@kernel
def solve(params, qp, trace):
    """Solve with the chosen solver of our own and check the solution; an MpcStatus."""
    return solve_without_limits(qp, params.mpc_prediction_horizon)
