# SPDX-License-Identifier: Apache-2.0
"""The Cholesky factor and the unconstrained solve against NumPy."""

from typing import Any

import numpy as np
import pytest

from safety_island.control.cholesky import factorize
from safety_island.control.qp_alone import solve_problem_without_limits
from safety_island.control.qp_records import QP
from safety_island.control.status import MpcStatus
from safety_island.kernel.kernel import entry
from tests.control.qp_problems import RECORDED, random_hessian, recorded


@entry(QP, int)
def factorize_problem(qp: Any, n: int) -> Any:
    """Factorize H of a problem that stands alone."""
    return factorize(qp[0], n)


@pytest.fixture(autouse=True, scope="module")
def _prepared() -> None:
    factorize_problem.prepare()
    solve_problem_without_limits.prepare()


def status_of(h: np.ndarray) -> MpcStatus:
    q = np.zeros(1, QP)
    q[0].H[: len(h), : len(h)] = h
    return MpcStatus(factorize_problem.call(q, len(h)))


@pytest.mark.parametrize("n", [*range(1, 12), 25, 49, 50, 63, 64])
def test_factor_and_solution_agree_with_numpy(n: int) -> None:
    rng = np.random.default_rng(n)
    h = random_hessian(rng, n, 1e3)
    q = np.zeros(1, QP)
    q[0].H[:] = np.nan  # what lies outside the problem must not matter
    q[0].qp_R[:] = np.nan
    q[0].H[:n, :n] = h
    q[0].f[:n] = rng.normal(size=n)
    assert solve_problem_without_limits.call(q, n) == MpcStatus.SOLVED
    factor = np.triu(q[0].qp_R[:n, :n])
    np.testing.assert_allclose(factor.T @ factor, h, rtol=0, atol=1e-12 * np.abs(h).max())
    np.testing.assert_array_equal(q[0].H[:n, :n], h)
    expected = -np.linalg.solve(h, q[0].f[:n])
    np.testing.assert_allclose(q[0].u[:n], expected, rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("name", ["s_curve", "lane_change"])
def test_recorded_problem_gives_the_recorded_solution(name: str) -> None:
    q, n = recorded(name)
    assert solve_problem_without_limits.call(q, n) == MpcStatus.SOLVED
    expected = -np.linalg.solve(q[0].H[:n, :n], q[0].f[:n])
    np.testing.assert_allclose(q[0].u[:n], expected, rtol=0, atol=1e-13)
    with np.load(RECORDED[name]) as file:
        if "Uex" in file:
            np.testing.assert_allclose(q[0].u[:n], file["Uex"], rtol=0, atol=1e-12)


@pytest.mark.parametrize("n", [1, 2, 5, 6])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan])
def test_pivot_that_is_not_positive_is_refused(n: int, value: float) -> None:
    for row in range(n):
        h = np.eye(n)
        h[row, row] = value
        assert status_of(h) == MpcStatus.NOT_POSITIVE_DEFINITE


def test_indefinite_and_singular_matrices_are_refused() -> None:
    assert status_of(np.array([[1.0, 2.0], [2.0, 1.0]])) == MpcStatus.NOT_POSITIVE_DEFINITE
    assert status_of(np.ones((3, 3))) == MpcStatus.NOT_POSITIVE_DEFINITE


@pytest.mark.parametrize(
    ("diagonal", "expected"),
    [
        ([1.0001e-9], MpcStatus.SOLVED),
        ([0.9999e-9], MpcStatus.NOT_POSITIVE_DEFINITE),
        ([1e-5, 1e-5, 1.0], MpcStatus.NOT_POSITIVE_DEFINITE),
        ([1e-5, 1e-5, 1e2], MpcStatus.SOLVED),
        ([1e120] * 4 + [1e-120] * 4, MpcStatus.SOLVED),  # no overflow on the way
        ([1e120, 1e-120] * 4, MpcStatus.SOLVED),
        ([1e150] * 8, MpcStatus.SOLVED),
        ([0.1] * 10, MpcStatus.NOT_POSITIVE_DEFINITE),
    ],
)
def test_determinant_below_the_limit_of_the_firmware_is_refused(
    diagonal: list[float], expected: MpcStatus
) -> None:
    assert status_of(np.diag(diagonal)) == expected
