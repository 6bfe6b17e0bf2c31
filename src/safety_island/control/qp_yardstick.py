"""The yardstick that tick times are measured in: one cold solve of a recorded problem by OSQP.

A machine's speed drifts; a ratio to this, measured in the same run, does not. The problem is tick
40 of the golden run ``s_curve`` at 0.15 s. Needs the extra ``safety-island[osqp]``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from safety_island.control.osqp_solver import OSQP_SOLVED, SparseProblem, sparse_problem

HORIZON = 50
PROBLEM = Path(__file__).with_name("qp_yardstick.npz")


def yardstick_problem() -> SparseProblem:
    """Load the recorded problem; raises ConfigurationError when osqp is not installed."""
    with np.load(PROBLEM) as recorded:
        return sparse_problem(recorded, HORIZON)


def yardstick(problem: SparseProblem) -> None:
    """Solve once: set-up, solve, polish. The caller takes the time of this call.

    Raises RuntimeError when OSQP does not report a solution, as the time then means nothing.
    """
    status = int(problem.solve().info.status_val)
    if status != OSQP_SOLVED:
        raise RuntimeError(f"the yardstick problem ended with OSQP status {status}, expected 1")
