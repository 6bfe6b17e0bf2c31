# SPDX-License-Identifier: Apache-2.0
"""The active-set solver by itself: its factor of the working set, and its own way to infeasible."""

from typing import Any

import numpy as np
import pytest

from safety_island.control.cholesky import factorize
from safety_island.control.daqp import solve_dual
from safety_island.control.limits import MAX_HORIZON
from safety_island.control.qp_records import QP
from safety_island.control.qp_working_set import append, remove
from safety_island.control.status import MpcStatus
from safety_island.kernel.kernel import entry
from tests.control.qp_problems import random_problem, recorded, smooth_hessian


@entry(QP, int, int, int)
def append_constraint(qp: Any, n: int, k: int, constraint: int) -> Any:
    """Append a constraint at its upper bound; 1 when it is independent of the k others."""
    return 1 if append(qp[0], n, k, constraint, 1) else 0


@entry(QP, int, int)
def remove_position(qp: Any, k: int, j: int) -> Any:
    """Remove a position of the working set."""
    return remove(qp[0], k, j)


@entry(QP, int, int)
def solve_directly(qp: Any, n: int, limit: int) -> Any:
    """Factorize, take u = 0 as the unconstrained minimiser, and run the solver alone."""
    q = qp[0]
    factorize(q, n)
    for i in range(n):
        q.qp_free[i] = 0.0
    q.qp_iterations = 0
    return solve_dual(q, n, limit)


@entry(QP, int)
def factorize_only(qp: Any, n: int) -> Any:
    """Factorize H."""
    return factorize(qp[0], n)


@pytest.fixture(autouse=True, scope="module")
def _prepared() -> None:
    for kernel in (append_constraint, remove_position, solve_directly, factorize_only):
        kernel.prepare()


def row_of(constraint: int, n: int) -> np.ndarray:
    row = np.zeros(n)
    i = constraint % MAX_HORIZON
    row[i] = 1.0
    if constraint > MAX_HORIZON:
        row[i - 1] = -1.0
    return row


def fresh(n: int, seed: int) -> np.ndarray:
    q = random_problem(np.random.default_rng(seed), n, smooth_hessian(n, 1e4), "rows")
    q[0].qp_slot[:] = np.arange(MAX_HORIZON + 1)
    assert factorize_only.call(q, n) == MpcStatus.SOLVED
    return q


@pytest.mark.parametrize("seed", range(3))
def test_factor_follows_the_working_set(seed: int) -> None:
    n, k = 40, 0
    q = fresh(n, seed)
    rng = np.random.default_rng(seed)
    inverse = np.linalg.inv(q[0].H[:n, :n])
    for _ in range(120):
        candidates = [c for c in (*range(n), *range(64, 64 + n)) if c not in q[0].qp_active[:k]]
        constraint = int(rng.choice(candidates))
        if k and (rng.random() < 0.4 or k > 30):
            k = remove_position.call(q, k, int(rng.integers(0, k)))
        elif append_constraint.call(q, n, k, constraint):
            k += 1
        rows = np.array([row_of(c, n) for c in q[0].qp_active[:k]]).reshape(k, n)
        lower = np.tril(q[0].qp_L[:k, :k], -1) + np.eye(k)
        gram = lower @ np.diag(q[0].qp_D[:k]) @ lower.T
        expected = rows @ inverse @ rows.T
        np.testing.assert_allclose(gram, expected, rtol=0, atol=1e-11)
        np.testing.assert_allclose(lower @ q[0].qp_y[:k], q[0].qp_excess[:k], rtol=0, atol=1e-9)
    assert sorted(q[0].qp_slot.tolist()) == list(range(MAX_HORIZON + 1))


@pytest.mark.parametrize(
    "dependent", [(0, 64), (64, 0), (3, 4, 68), (3, 68, 4), (64, 65, 66, 2), (5, 5)]
)
def test_dependent_row_is_recognised(dependent: tuple[int, ...]) -> None:
    q = fresh(20, 1)
    answers = [append_constraint.call(q, 20, k, c) for k, c in enumerate(dependent)]
    assert answers == [1] * (len(dependent) - 1) + [0]


def test_contradiction_that_was_not_seen_before_ends_in_infeasible() -> None:
    q, n = recorded("u_turn")
    q[0].lbA[0] = 0.8
    q[0].ubA[0] = 0.9
    assert solve_directly.call(q, n, 500) == MpcStatus.INFEASIBLE
    assert q[0].qp_active_count == 0
