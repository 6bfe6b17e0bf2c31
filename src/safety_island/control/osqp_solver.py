# SPDX-License-Identifier: Apache-2.0
"""The MPC's quadratic programme by OSQP, as the recordings that name it were made.

Imported only when chosen; needs the extra ``safety-island[osqp]``. Settings as in the firmware's
unbuilt OSQP interface, with its fixed interval of 100 iterations for rho; every solve is cold.
"""

from __future__ import annotations

import contextlib
import io
from typing import Any

import numpy as np
import numpy.typing as npt

from safety_island.control.limits import MAX_HORIZON
from safety_island.control.qp import MAX_ITERATIONS
from safety_island.control.qp_alone import check_problem, solve_problem
from safety_island.control.qp_check import MAX_VIOLATION
from safety_island.control.qp_records import QP
from safety_island.control.status import MpcStatus
from safety_island.extras import require

Array = npt.NDArray[np.float64]

SETTINGS: dict[str, Any] = {
    "alpha": 1.6,
    "eps_abs": 2.2e-16,
    "eps_rel": 1e-4,
    "eps_prim_inf": 1e-4,
    "eps_dual_inf": 1e-4,
    "max_iter": 4000,
    "polishing": True,
    "adaptive_rho_interval": 100,
    "verbose": False,
}
SMALLEST_ENTRY = 1e-9
"""Entries of a matrix below this magnitude are left out of its sparse form."""

OSQP_SOLVED = 1
_FAILURES = {
    3: MpcStatus.INFEASIBLE,
    4: MpcStatus.INFEASIBLE,
    7: MpcStatus.ITERATION_LIMIT,
}
"""OSQP's own status numbers; whatever is not listed is SOLVER_ERROR."""


def _libraries() -> tuple[Any, Any]:
    """Return osqp and scipy.sparse, or say how to get them."""
    require("osqp", "qp_solver_type: osqp", ", or choose daqp or unconstraint_fast")
    import osqp
    import scipy.sparse

    return osqp, scipy.sparse


class SparseProblem:
    """A quadratic programme in OSQP's form: rows [I; D], sparse upper triangle of H.

    ``h`` is (n, n), the others (n,); units as in ``QP_COLUMNS``. ``refusal`` is what ``solve``
    raises for a problem that OSQP does not take (H not convex or not finite).
    """

    def __init__(
        self, h: Array, f: Array, boxes: tuple[Array, Array], rates: tuple[Array, Array]
    ) -> None:
        self._osqp, sparse = _libraries()
        self.refusal: type[Exception] = self._osqp.OSQPException
        n = f.size
        kept = np.triu(np.where(np.abs(h) < SMALLEST_ENTRY, 0.0, h))
        self.hessian = sparse.csc_matrix(kept)
        self.gradient = np.ascontiguousarray(f)
        self.rows = sparse.vstack(
            [sparse.eye(n), sparse.eye(n) - sparse.eye(n, k=-1)], format="csc"
        )
        self.lower = np.concatenate([boxes[0], rates[0]])
        self.upper = np.concatenate([boxes[1], rates[1]])

    def solve(self) -> Any:
        """Set up, solve and polish once, cold and silent; return OSQP's results."""
        with contextlib.redirect_stdout(io.StringIO()):  # it reports a skipped polish regardless
            solver = self._osqp.OSQP()
            solver.setup(self.hessian, self.gradient, self.rows, self.lower, self.upper, **SETTINGS)
            return solver.solve(raise_error=False)

    def touched(self, u: Array) -> int:
        """Return how many constraints stand at a bound at ``u`` (n,)."""
        values = self.rows @ u
        near = (values >= self.upper - MAX_VIOLATION) | (values <= self.lower + MAX_VIOLATION)
        return int(np.count_nonzero(near))


def sparse_problem(q: Any, n: int) -> SparseProblem:
    """Return the problem that a record (or a mapping of arrays) with ``QP_COLUMNS`` describes."""
    vector = {key: np.ravel(q[key])[:n] for key in ("f", "lb", "ub", "lbA", "ubA")}
    return SparseProblem(
        np.asarray(q["H"])[:n, :n],
        vector["f"],
        (vector["lb"], vector["ub"]),
        (vector["lbA"], vector["ubA"]),
    )


class OsqpSolver:
    """Solves the problem of a record with OSQP.

    ``horizon`` is the number of steps. Raises ConfigurationError when osqp is not installed.
    """

    def __init__(self, horizon: int) -> None:
        if not 1 <= horizon <= MAX_HORIZON:
            raise ValueError(f"horizon {horizon}: expected 1 to {MAX_HORIZON}")
        _libraries()
        self.horizon = horizon
        self._own = np.zeros(1, QP)
        for kernel in (solve_problem, check_problem):
            kernel.prepare()

    def solve(self, q: Any) -> MpcStatus:
        """Set ``u`` of a record with ``QP_COLUMNS`` from its problem.

        OSQP decides whether there is a solution. Its vector is used when it passes the check of
        optimality: when its polish succeeded. Where it skips the polish (no bound touched) or the
        polish fails, it is only exact to 1e-2 .. 1e-4 rad, and the exact solver gives the vector.
        """
        problem = sparse_problem(q, self.horizon)
        if np.any(problem.lower > problem.upper):
            return MpcStatus.INFEASIBLE  # OSQP refuses such bounds with an exception
        try:
            result = problem.solve()
        except problem.refusal:
            return MpcStatus.SOLVER_ERROR
        status = int(result.info.status_val)
        if status != OSQP_SOLVED:
            return _FAILURES.get(status, MpcStatus.SOLVER_ERROR)
        q["qp_iterations"] = int(result.info.iter)
        return self._take(q, problem, result.x)

    def _take(self, q: Any, problem: SparseProblem, vector: Array) -> MpcStatus:
        own = self._own[0]
        for key in ("H", "f", "lb", "ub", "lbA", "ubA"):
            own[key] = q[key]
        own["u"][: self.horizon] = vector
        status = check_problem.call(self._own, self.horizon)
        if status != MpcStatus.SOLVED:
            status = solve_problem.call(self._own, self.horizon, MAX_ITERATIONS)
        for key in ("u", "qp_violation", "qp_residual"):
            q[key] = own[key]
        q["qp_active_count"] = problem.touched(own["u"][: self.horizon])
        return MpcStatus(status)
