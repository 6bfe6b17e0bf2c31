# SPDX-License-Identifier: Apache-2.0
"""The constrained solve against PyPI's daqp, on recorded problems and families of hard ones."""

import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from safety_island.control.qp import MAX_ITERATIONS, QP
from safety_island.control.qp_alone import solve_problem
from safety_island.control.status import MpcStatus
from tests.control.qp_problems import (
    BOUNDS,
    RECORDED,
    cost,
    problem,
    random_hessian,
    random_problem,
    recorded,
    reference,
    smooth_hessian,
)

FAMILIES = ("plain", "rows", "equal", "frozen", "double", "narrow")


@pytest.fixture(autouse=True, scope="module")
def _prepared() -> None:
    solve_problem.prepare()


def solve(q: np.ndarray, n: int, limit: int = MAX_ITERATIONS) -> MpcStatus:
    return MpcStatus(solve_problem.call(q, n, limit))


@pytest.mark.parametrize(("name", "active"), [("s_curve", 0), ("lane_change", 0), ("u_turn", 44)])
def test_recorded_problem_gives_the_recorded_solution(name: str, active: int) -> None:
    q, n = recorded(name)
    assert solve(q, n) == MpcStatus.SOLVED
    assert q[0].qp_active_count == active
    assert (q[0].qp_iterations > 0) == (active > 0)
    np.testing.assert_allclose(q[0].u[:n], reference(q, n)[0], rtol=0, atol=1e-12)
    with np.load(RECORDED[name]) as file:
        if "Uex" in file:
            np.testing.assert_allclose(q[0].u[:n], file["Uex"], rtol=0, atol=1e-12)


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("condition", [1e1, 1e3, 1e6, 1e9])
def test_random_problem_has_the_reference_solution(family: str, condition: float) -> None:
    rng = np.random.default_rng(11)
    for trial in range(12):
        n = 50 if trial % 3 == 0 else int(rng.integers(1, 65))
        smooth = trial % 2 == 0
        h = smooth_hessian(n, condition) if smooth else random_hessian(rng, n, condition)
        q = random_problem(rng, n, h, family)
        assert solve(q, n) == MpcStatus.SOLVED
        assert q[0].qp_violation <= 1e-11
        assert q[0].qp_residual <= 1e-10
        expected, flag = reference(q, n)
        own, other = cost(q, n, q[0].u[:n]), cost(q, n, expected)
        assert own <= other + 1e-9 * abs(other)
        if flag == 1 and condition < 1e5:
            scale = max(1.0, np.abs(expected).max())
            np.testing.assert_allclose(q[0].u[:n], expected, rtol=0, atol=1e-10 * scale)


@pytest.mark.parametrize("seed", range(4))
def test_vertex_where_more_bounds_meet_than_there_are_steps(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 30
    inside = np.cumsum(rng.normal(size=n)) * 0.1
    change = np.diff(inside, prepend=0.0)
    slack = rng.uniform(0.0, 1.0, (4, n)) * (rng.random((4, n)) < 0.3)
    bounds = (inside - slack[0], inside + slack[1], change - slack[2], change + slack[3])
    for condition in (1e1, 1e4, 1e7):
        q = problem(random_hessian(rng, n, condition), rng.normal(size=n) * 10, *bounds)
        assert solve(q, n) == MpcStatus.SOLVED
        assert q[0].qp_residual <= 1e-10


def test_single_feasible_point_is_found() -> None:
    rng = np.random.default_rng(3)
    only = np.cumsum(rng.normal(size=50)) * 0.1
    change = np.diff(only, prepend=0.0)
    q = problem(smooth_hessian(50, 1e4), rng.normal(size=50), only, only, change, change)
    assert solve(q, 50) == MpcStatus.SOLVED
    np.testing.assert_allclose(q[0].u[:50], only, rtol=0, atol=1e-11)


def test_two_steps_by_hand() -> None:
    """Pull to (3, 3) with u_0 <= 1 and u_1 - u_0 <= 0.5: u = (1, 1.5), multipliers 3.5 and 1.5."""
    wide = np.full(2, 9.0)
    box, rate = np.array([1.0, 9.0]), np.array([9.0, 0.5])
    q = problem(np.eye(2), np.full(2, -3.0), -wide, box, -wide, rate)
    assert solve(q, 2) == MpcStatus.SOLVED
    np.testing.assert_allclose(q[0].u[:2], [1.0, 1.5], rtol=0, atol=1e-14)
    found = dict(zip(q[0].qp_active[:2].tolist(), q[0].qp_multiplier[:2], strict=True))
    assert found == {0: pytest.approx(3.5), 65: pytest.approx(1.5)}


def contradiction(kind: str) -> np.ndarray:
    """A problem without a feasible point."""
    n = 20
    low, high = np.full(n, -0.7), np.full(n, 0.7)
    low_rate, high_rate = np.full(n, -0.1), np.full(n, 0.1)
    if kind == "first":  # the previous command is beyond the angle limit
        low_rate[0], high_rate[0] = 0.8, 1.0
    if kind == "far":  # step 5 cannot be reached from step 0
        low_rate[0] = high_rate[0] = -0.3
        low[5] = 0.25
    if kind == "crossed":
        low[7], high[7] = 0.2, 0.1
    if kind == "crossed rate":
        low_rate[7], high_rate[7] = 0.2, 0.1
    if kind == "nan":
        high_rate[7] = math.nan
    return problem(np.eye(n), np.ones(n), low, high, low_rate, high_rate)


@pytest.mark.parametrize("kind", ["first", "far", "crossed", "crossed rate", "nan"])
def test_contradicting_bounds_are_infeasible(kind: str) -> None:
    q = contradiction(kind)
    assert solve(q, 20) == MpcStatus.INFEASIBLE
    assert q[0].qp_active_count == 0


def test_iteration_limit_is_told() -> None:
    q, n = recorded("u_turn")
    assert solve(q, n, 3) == MpcStatus.ITERATION_LIMIT
    assert q[0].qp_active_count == 0
    assert solve(q, n) == MpcStatus.SOLVED
    assert q[0].qp_iterations < 15


def test_nothing_is_kept_from_one_solve_to_the_next() -> None:
    rng = np.random.default_rng(8)
    used = np.zeros(1, QP)
    for trial in range(60):
        n = 50 if trial % 4 else int(rng.integers(1, 65))
        condition = 10.0 ** rng.integers(1, 8)
        fresh = random_problem(
            rng, n, smooth_hessian(n, condition), FAMILIES[trial % len(FAMILIES)]
        )
        for key in ("H", "f", *BOUNDS):
            used[0][key] = fresh[0][key]
        assert solve(used, n) == solve(fresh, n) == MpcStatus.SOLVED
        assert used[0].u[:n].tobytes() == fresh[0].u[:n].tobytes()
        assert used[0].qp_iterations == fresh[0].qp_iterations
        used[0].u[:] = np.nan  # as after a failure


def test_not_positive_definite_is_told_before_the_bounds() -> None:
    q = contradiction("first")
    q[0].H[3, 3] = -1.0
    assert solve(q, 20) == MpcStatus.NOT_POSITIVE_DEFINITE


def test_not_finite_gradient_never_gives_a_solution() -> None:
    for value in (math.nan, math.inf):
        q, n = recorded("u_turn")
        q[0].f[3] = value
        assert solve(q, n) not in (MpcStatus.SOLVED, MpcStatus.SOLUTION_VIOLATES)


SOLVE_FILE = """
import sys
import numpy as np
from safety_island.control.qp import QP
from safety_island.control.qp_alone import solve_problem
solve_problem.prepare()
q = np.zeros(1, QP)
with open(sys.argv[1], "rb") as file:
    for n in (5, 8) * 6:
        q[0] = np.frombuffer(file.read(QP.itemsize), QP)[0]
        status = solve_problem.call(q, n, 200)
        print(n, status, q[0].qp_iterations, q[0].u[:n].tobytes().hex())
"""


def test_plain_python_gives_the_same_bytes(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    problems = tmp_path / "problems"
    with problems.open("wb") as file:  # from a file, as BLAS need not repeat its last bits
        for family in FAMILIES:
            for n in (5, 8):
                file.write(random_problem(rng, n, smooth_hessian(n, 1e3), family).tobytes())
    outputs = [
        subprocess.run(
            [sys.executable, "-W", "error", "-c", SOLVE_FILE, str(problems)],
            env={**os.environ, "SAFETY_ISLAND_JIT": jit, "PYTHONPATH": os.pathsep.join(sys.path)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for jit in ("0", "1")
    ]
    assert outputs[0] == outputs[1]
    lines = [line.split() for line in outputs[0].splitlines()]
    assert all(line[1] == "0" for line in lines)
    assert sum(int(line[2]) for line in lines) > 20
