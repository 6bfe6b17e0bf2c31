# SPDX-License-Identifier: Apache-2.0
"""The check of a solution: what it accepts, and that every other point is refused."""

import math
from typing import Any

import numpy as np
import pytest

from safety_island.control.qp import MAX_ITERATIONS, check_unconstrained
from safety_island.control.qp_alone import (
    check_problem,
    solve_problem,
    solve_problem_without_limits,
)
from safety_island.control.qp_records import QP
from safety_island.control.status import MpcStatus
from safety_island.kernel.kernel import entry
from tests.control.qp_problems import problem, random_problem, recorded, smooth_hessian

SOLVER_MEMORY = [name for name in QP.names or () if name.startswith("qp_")]


@entry(QP, int)
def check_without_limits(qp: Any, n: int) -> Any:
    """Check u as the unconstrained minimiser."""
    return check_unconstrained(qp[0], n)


@pytest.fixture(autouse=True, scope="module")
def _prepared() -> None:
    for kernel in (check_problem, solve_problem, solve_problem_without_limits):
        kernel.prepare()
    check_without_limits.prepare()


def check(q: np.ndarray, n: int) -> MpcStatus:
    return MpcStatus(check_problem.call(q, n))


def solved(name: str) -> tuple[np.ndarray, int]:
    q, n = recorded(name)
    assert solve_problem.call(q, n, MAX_ITERATIONS) == MpcStatus.SOLVED
    return q, n


def test_solver_memory_is_not_read() -> None:
    q, n = solved("u_turn")
    for name in SOLVER_MEMORY:
        q[0][name] = np.nan if q[0][name].dtype.kind == "f" else -1
    assert check(q, n) == MpcStatus.SOLVED
    assert q[0].qp_residual < 1e-12


@pytest.mark.parametrize("name", ["s_curve", "lane_change", "u_turn"])
@pytest.mark.parametrize("size", [1e-2, 1e-4, 1e-5])
def test_perturbed_solution_is_refused(name: str, size: float) -> None:
    q, n = solved(name)
    best = q[0].u.copy()
    for step in range(n):
        for change in (size, -size):
            q[0].u[:] = best
            q[0].u[step] += change
            assert check(q, n) in (MpcStatus.SOLUTION_VIOLATES, MpcStatus.SOLUTION_NOT_OPTIMAL)


def test_perturbed_solutions_of_random_problems_are_refused() -> None:
    rng = np.random.default_rng(4)
    for trial in range(40):
        n = int(rng.integers(2, 65))
        q = random_problem(rng, n, smooth_hessian(n, 1e3), ("plain", "rows")[trial % 2])
        assert solve_problem.call(q, n, MAX_ITERATIONS) == MpcStatus.SOLVED
        direction = rng.normal(size=n)
        q[0].u[:n] += 1e-4 * np.abs(q[0].u[:n]).max() * direction / np.abs(direction).max()
        assert check(q, n) != MpcStatus.SOLVED


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_not_finite_solution_is_refused(value: float) -> None:
    for step in (0, 25, 49):
        q, n = solved("u_turn")
        q[0].u[step] = value
        assert check(q, n) == MpcStatus.SOLUTION_NOT_FINITE
        assert q[0].qp_violation == q[0].qp_residual == math.inf


@pytest.mark.parametrize("bound", ["lb", "ub", "lbA", "ubA"])
def test_not_finite_bound_is_refused(bound: str) -> None:
    q, n = solved("u_turn")
    q[0][bound][7] = math.nan
    assert check(q, n) == MpcStatus.SOLUTION_VIOLATES


@pytest.mark.parametrize("field", ["H", "f"])
@pytest.mark.parametrize("name", ["s_curve", "u_turn"])
def test_not_finite_objective_is_refused(field: str, name: str) -> None:
    q, n = solved(name)
    q[0][field][12] = math.nan
    assert check(q, n) == MpcStatus.SOLUTION_NOT_OPTIMAL


def one_step(gradient: float, low: float, high: float, rate_low: float, rate_high: float) -> int:
    """Status of u = 0 when H = 1 and f is the gradient there."""
    bounds = [np.array([value]) for value in (low, high, rate_low, rate_high)]
    return check(problem(np.eye(1), np.array([gradient]), *bounds), 1)


@pytest.mark.parametrize(
    ("gradient", "bounds", "expected"),
    [
        (0.0, (-1, 1, -1, 1), MpcStatus.SOLVED),  # free
        (-1.0, (-1, 0, -1, 1), MpcStatus.SOLVED),  # held back by the upper bound
        (1.0, (-1, 0, -1, 1), MpcStatus.SOLUTION_NOT_OPTIMAL),  # wrong sign of the multiplier
        (1.0, (0, 1, -1, 1), MpcStatus.SOLVED),
        (-1.0, (0, 1, -1, 1), MpcStatus.SOLUTION_NOT_OPTIMAL),
        (-1.0, (-1, 1, -1, 0), MpcStatus.SOLVED),  # by the first rate row
        (1.0, (-1, 1, -1, 0), MpcStatus.SOLUTION_NOT_OPTIMAL),
        (1.0, (-1, 1, 0, 1), MpcStatus.SOLVED),
        (1.0, (0, 0, -1, 1), MpcStatus.SOLVED),  # an equality takes either sign
        (-1.0, (0, 0, -1, 1), MpcStatus.SOLVED),
        (-1.0, (-1, 1e-8, -1, 1), MpcStatus.SOLUTION_NOT_OPTIMAL),  # near is not touched
        (0.0, (-1, -1e-8, -1, 1), MpcStatus.SOLUTION_VIOLATES),
        (0.0, (-1, 1, 1e-8, 1), MpcStatus.SOLUTION_VIOLATES),
    ],
)
def test_one_step_by_hand(
    gradient: float, bounds: tuple[float, float, float, float], expected: MpcStatus
) -> None:
    assert one_step(gradient, *bounds) == expected


@pytest.mark.parametrize(
    ("gradient", "expected"),
    [
        # The rate row between the steps is at its upper bound and joins them: with u_0 free, only
        # a pull of both that cancels is balanced, and only when it pulls them apart.
        ((1.0, -1.0), MpcStatus.SOLVED),
        ((-1.0, 1.0), MpcStatus.SOLUTION_NOT_OPTIMAL),
        ((1.0, -0.9), MpcStatus.SOLUTION_NOT_OPTIMAL),
        ((1.0, -1.1), MpcStatus.SOLUTION_NOT_OPTIMAL),
    ],
)
def test_two_joined_steps_by_hand(gradient: tuple[float, float], expected: MpcStatus) -> None:
    wide = np.array([9.0, 9.0])
    q = problem(np.eye(2), np.array(gradient), -wide, wide, -wide, np.array([9.0, 0.0]))
    assert check(q, 2) == expected


def test_unconstrained_check() -> None:
    q, n = recorded("s_curve")
    solve_problem_without_limits.call(q, n)
    assert check_without_limits.call(q, n) == MpcStatus.SOLVED
    assert q[0].qp_residual < 1e-12
    q[0].u[9] += 1e-5
    assert check_without_limits.call(q, n) == MpcStatus.SOLUTION_NOT_OPTIMAL
    q[0].u[9] = math.nan
    assert check_without_limits.call(q, n) == MpcStatus.SOLUTION_NOT_FINITE


@pytest.mark.parametrize("gradient", [(-2.0, 1.0), (2.0, 1.0), (2.0, -1.0), (-2.0, -1.0)])
def test_a_step_beside_a_gap_counts_from_the_bound_that_was_missed(
    gradient: tuple[float, float],
) -> None:
    """No bound is touched, so each step misses zero by its own gradient alone."""
    wide = np.array([9.0, 9.0])
    q = problem(np.eye(2), np.array(gradient), -wide, wide, -wide, wide)
    assert check(q, 2) == MpcStatus.SOLUTION_NOT_OPTIMAL
    assert q[0].qp_residual == 1.0, "the greatest gradient over itself"


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_touched_bound_of_the_angle_balances_its_own_step_alone(side: float) -> None:
    """No rate is at its bound, so nothing of the last step's multiplier reaches the one before."""
    wide, touched = np.array([9.0, 9.0]), np.array([9.0, 0.0])
    low, high = (-touched, wide) if side > 0.0 else (-wide, touched)
    q = problem(np.eye(2), np.array([side, 0.0]), low, high, -wide, wide)
    assert check(q, 2) == MpcStatus.SOLUTION_NOT_OPTIMAL
    assert q[0].qp_residual == 1.0


@pytest.mark.parametrize(
    ("gradient", "expected"),
    [
        ((-1.0, 1.0), MpcStatus.SOLVED),
        ((1.0, -1.0), MpcStatus.SOLUTION_NOT_OPTIMAL),
        ((-1.0, 0.9), MpcStatus.SOLUTION_NOT_OPTIMAL),
        ((-1.0, 1.1), MpcStatus.SOLUTION_NOT_OPTIMAL),
    ],
)
def test_two_steps_joined_at_the_lower_rate_by_hand(
    gradient: tuple[float, float], expected: MpcStatus
) -> None:
    """The mirror image of the upper one."""
    wide = np.array([9.0, 9.0])
    q = problem(np.eye(2), np.array(gradient), -wide, wide, np.array([-9.0, 0.0]), wide)
    assert check(q, 2) == expected
