# SPDX-License-Identifier: Apache-2.0
"""OSQP behind the record: parity with the recordings, and every way to fail."""

import math
from typing import Any

import numpy as np
import pytest

from safety_island import extras
from safety_island.control.osqp_solver import OsqpSolver
from safety_island.control.status import MpcStatus
from safety_island.errors import ConfigurationError
from tests.control.qp_problems import RECORDED, random_problem, recorded, smooth_hessian


@pytest.fixture(scope="module")
def solver() -> OsqpSolver:
    pytest.importorskip("osqp")
    return OsqpSolver(50)


@pytest.mark.parametrize("name", ["lane_change", "u_turn"])
def test_recorded_problem_gives_the_recorded_solution(name: str, solver: OsqpSolver) -> None:
    q, n = recorded(name)
    assert solver.solve(q[0]) == MpcStatus.SOLVED
    with np.load(RECORDED[name]) as file:
        np.testing.assert_allclose(q[0].u[:n], file["Uex"], rtol=0, atol=1e-9)
    assert q[0].qp_iterations > 0
    assert q[0].qp_active_count == (44 if name == "u_turn" else 0)
    assert q[0].qp_residual < 1e-8


def test_vector_is_exact_whether_the_polish_succeeds_or_not(solver: OsqpSolver) -> None:
    rng = np.random.default_rng(6)
    for family in ("plain", "rows") * 6:
        q = random_problem(rng, 50, smooth_hessian(50, 1e3), family)
        status = solver.solve(q[0])
        if status == MpcStatus.SOLVED:
            assert q[0].qp_residual < 1e-8
            assert q[0].qp_violation < 1e-8


def test_nothing_is_printed(solver: OsqpSolver, capfd: pytest.CaptureFixture[str]) -> None:
    q, _ = recorded("s_curve")  # no bound is touched: OSQP would report a skipped polish
    assert solver.solve(q[0]) == MpcStatus.SOLVED
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("field", "index", "value"),
    [("H", (3, 3), math.nan), ("H", (3, 3), -1e5), ("f", 2, math.nan), ("lb", 5, math.nan)],
)
def test_unusable_problem_is_a_status(
    solver: OsqpSolver, field: str, index: Any, value: float
) -> None:
    q, n = recorded("u_turn")
    q[0].u[:n] = 0.25
    q[0][field][index] = value
    assert solver.solve(q[0]) in (MpcStatus.SOLVER_ERROR, MpcStatus.ITERATION_LIMIT)
    assert (q[0].u[:n] == 0.25).all()  # the vector of a failed solve is not taken


@pytest.mark.parametrize(("field", "value"), [("lb", 0.9), ("lbA", 0.75)])
def test_contradicting_bounds_never_give_a_vector(
    solver: OsqpSolver, field: str, value: float
) -> None:
    q, n = recorded("u_turn")
    q[0].u[:n] = 0.25
    q[0][field][0] = value
    assert solver.solve(q[0]) in (MpcStatus.INFEASIBLE, MpcStatus.ITERATION_LIMIT)
    assert (q[0].u[:n] == 0.25).all()


def test_missing_package_is_one_clear_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda name: None)
    with pytest.raises(ConfigurationError, match=r"osqp.*not installed.*safety-island\[osqp\]"):
        OsqpSolver(50)


@pytest.mark.parametrize("horizon", [0, 65])
def test_horizon_out_of_range_is_refused(horizon: int) -> None:
    with pytest.raises(ValueError, match="expected 1 to 64"):
        OsqpSolver(horizon)
