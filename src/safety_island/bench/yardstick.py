# SPDX-License-Identifier: Apache-2.0
"""The yardstick of the ratios that ``island bench`` measures, as ``ratios.YARDSTICK`` defines it.

A machine's speed drifts by a third from minute to minute, so times are compared with a solve that
is measured in the same run. What OSQP's Python interface adds does not count: that makes the
yardstick short and every ratio to it large.
"""

from __future__ import annotations

from importlib.resources import files
from typing import Any

import numpy as np

from safety_island.control.osqp_solver import SparseProblem, sparse_problem

_HORIZON = 50


def problem() -> SparseProblem:
    """Return the problem of the yardstick: tick 40 of an S-curve, 50 steps, 100 constraints.

    Raises ConfigurationError when osqp is not installed.
    """
    with (
        (files(__package__) / "data" / "yardstick.npz").open("rb") as stream,
        np.load(stream) as data,
    ):
        arrays: dict[str, Any] = {name: data[name] for name in data.files}
    return sparse_problem(arrays, _HORIZON)


def measure_us(problem: SparseProblem) -> float:
    """Solve once, cold; return one yardstick [us]."""
    info = problem.solve().info
    return float(info.setup_time + info.solve_time + info.polish_time) * 1e6
