# SPDX-License-Identifier: Apache-2.0
"""The optimum by recursion against the condensed problem: same solutions, same statuses."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from safety_island import params
from safety_island.control.gradient import fill_gradient
from safety_island.control.lateral_state import LATERAL_STATE
from safety_island.control.qp_records import QP
from safety_island.control.records import PARAMS
from safety_island.control.recursion import solve_recursively
from safety_island.control.status import MpcStatus
from safety_island.kernel.kernel import entry
from safety_island.kernel.records import Records
from tests.control.condensed import condense_problem, solve_as_the_controller, solve_condensed
from tests.control.lateral_rig import Rig
from tests.control.test_condense import MODELS, random_rig

HORIZONS = (2, 3, 10, 11, 33, 50, 63, 64)
SOLVERS = ("unconstraint_fast", "daqp")
UNTOUCHED = 12345.0
OWN = ("qp_iterations", "qp_active_count")


@entry(PARAMS, LATERAL_STATE, QP)
def gradient_of_problem(parameters: Any, state: Any, qp: Any) -> Any:
    """Set ``qp_v`` to the gradient at ``u``, ``qp_residual`` to the greatest of its terms."""
    n = parameters[0].mpc_prediction_horizon
    qp[0].qp_residual = fill_gradient(parameters[0], state[0], qp[0].u, n, qp[0].qp_v)
    return 0


@entry(PARAMS, LATERAL_STATE, QP)
def solve_recursively_alone(parameters: Any, state: Any, qp: Any) -> Any:
    """1 where the recursion gives a solution."""
    n = parameters[0].mpc_prediction_horizon
    return 1 if solve_recursively(parameters[0], state[0], qp[0].u, n) else 0


@pytest.fixture(autouse=True, scope="module")
def _prepared() -> None:
    for kernel in (condense_problem, solve_as_the_controller, solve_condensed):
        kernel.prepare()
    gradient_of_problem.prepare()
    solve_recursively_alone.prepare()


class Problem:
    """What a tick of a rig has set up, to be solved in either way."""

    def __init__(self, rig: Rig) -> None:
        follower = rig.follower
        self.parameters: Records = follower._params.copy()
        self.state: Records = follower._lateral.copy()
        self.qp: Records = follower._qp.copy()
        self.n: int = rig.parameters.lateral.mpc_prediction_horizon

    def solved_by(self, kernel: Any) -> tuple[MpcStatus, Any]:
        """The status and the record in which the solution is, its H filled only if it was made."""
        qp = self.qp.copy()
        qp[0].H[:] = UNTOUCHED
        qp[0].u[:] = np.nan
        with np.errstate(all="ignore"):  # which plain Python would warn of
            status = kernel.call(self.parameters, self.state.copy(), qp)
        return MpcStatus(status), qp[0]

    def compare(self) -> tuple[MpcStatus, bool]:
        """Check that both ways end alike; the status, and whether the recursion was enough."""
        found, ours = self.solved_by(solve_as_the_controller)
        wanted, oracle = self.solved_by(solve_condensed)
        assert found is wanted
        is_free = bool(ours.H[0, 0] == UNTOUCHED)
        if found is MpcStatus.SOLVED:
            n = self.n
            np.testing.assert_allclose(ours.u[:n], oracle.u[:n], rtol=0, atol=1e-9)
            assert ours.qp_residual <= 1e-11
            assert ours.qp_violation <= 1e-9
            assert [ours[name] for name in OWN] == [oracle[name] for name in OWN]
        return found, is_free


def problem_of(seed: int, model: str, solver: str, n: int, **overrides: Any) -> Problem:
    """The third tick of a random drive with random weights."""
    rig = random_rig(seed, model, qp_solver_type=solver, mpc_prediction_horizon=n, **overrides)
    for _ in rig.ticks(3):
        pass
    return Problem(rig)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("n", HORIZONS)
def test_both_ways_give_the_same_solution(n: int, model: str, solver: str) -> None:
    """Random drives; with limits the recursion is enough in some of them and in others not."""
    free = [problem_of(seed, model, solver, n).compare() for seed in range(4)]
    assert all(status is MpcStatus.SOLVED for status, _ in free)
    if solver == "unconstraint_fast":
        assert all(is_free for _, is_free in free)


def test_with_limits_both_ways_are_taken() -> None:
    ways = {problem_of(seed, "kinematics", "daqp", 20).compare()[1] for seed in range(12)}
    assert ways == {True, False}


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", range(8))
def test_models_and_weights_at_random(model: str, seed: int) -> None:
    """No drive gives these: every weight and every number of the models of its own."""
    problem = problem_of(seed, model, SOLVERS[seed % 2], 10 + 6 * seed)
    rng = np.random.default_rng(seed)
    lat, n = problem.state[0], problem.n
    lat.A[:n] += np.where(lat.A[:n] % 1.0 != 0.0, rng.normal(0.0, 0.02, lat.A[:n].shape), 0.0)
    lat.B[:n] *= rng.uniform(0.5, 1.5, lat.B[:n].shape)
    lat.W[:n] *= rng.uniform(-2.0, 2.0, lat.W[:n].shape)
    lat.q_lat[:n] = rng.uniform(0.0, 3.0, n)
    lat.q_yaw[:n] = rng.uniform(0.0, 3.0, n)
    lat.pull[:n] = rng.normal(0.0, 0.3, n)
    factor = np.tril(np.triu(rng.normal(0.0, 0.5, (n, n)), -2))
    r = factor @ factor.T + np.eye(n)
    lat.r0[:n] = np.diag(r)
    lat.r1[1:n] = np.diag(r, -1)
    lat.r2[2:n] = np.diag(r, -2)
    assert problem.compare()[0] is MpcStatus.SOLVED


def poison(name: str, index: int | None, value: float) -> Callable[[Problem], None]:
    """Put one number into a column of the state, or in all its places."""

    def act(problem: Problem) -> None:
        column = problem.state[0][name]
        column[slice(None) if index is None else index] = value

    return act


REFUSED: dict[str, tuple[Callable[[Problem], None], MpcStatus]] = {
    "a weight that is NaN": (poison("q_lat", 3, math.nan), MpcStatus.INVALID_MATRIX),
    "a weight that is infinite": (poison("q_yaw", 0, math.inf), MpcStatus.INVALID_MATRIX),
    "a weight that overflows": (poison("r0", 2, 1e301), MpcStatus.INVALID_MATRIX),
    "a start that is NaN": (poison("x0_delayed", 0, math.nan), MpcStatus.INVALID_MATRIX),
    "a start that overflows": (poison("x0_delayed", 0, 1e308), MpcStatus.INVALID_MATRIX),
    "a model that is NaN": (poison("B", 4, math.nan), MpcStatus.INVALID_MATRIX),
    "a drift that is NaN": (poison("W", 4, math.nan), MpcStatus.INVALID_MATRIX),
    "a pull that is NaN": (poison("pull", 9, math.nan), MpcStatus.INVALID_MATRIX),
    "a negative weight": (poison("r0", 1, -1e4), MpcStatus.NOT_POSITIVE_DEFINITE),
    "a negative last weight": (poison("r0", 9, -1e4), MpcStatus.NOT_POSITIVE_DEFINITE),
}


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("case", REFUSED)
def test_both_ways_refuse_alike(case: str, model: str, solver: str) -> None:
    act, status = REFUSED[case]
    problem = problem_of(1, model, solver, 10)
    act(problem)
    assert problem.compare() == (status, False)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("model", MODELS)
def test_without_weights_the_problem_is_singular_in_both(model: str, solver: str) -> None:
    problem = problem_of(1, model, solver, 10)
    for name in ("q_lat", "q_yaw", "r0", "r1", "r2"):
        poison(name, None, 0.0)(problem)
    assert problem.compare() == (MpcStatus.NOT_POSITIVE_DEFINITE, False)


@pytest.mark.parametrize("share", [0.999, 1.001])
@pytest.mark.parametrize("n", [10, 11])
def test_both_have_the_firmwares_limit_of_the_determinant(n: int, share: float) -> None:
    """H is diagonal: the inputs move nothing, and each costs the same."""
    problem = problem_of(2, "kinematics", "unconstraint_fast", n)
    for name in ("B", "r1", "r2"):
        poison(name, None, 0.0)(problem)
    poison("r0", None, (share * 1e-9) ** (1.0 / n))(problem)
    wanted = MpcStatus.SOLVED if share > 1.0 else MpcStatus.NOT_POSITIVE_DEFINITE
    assert problem.compare() == (wanted, share > 1.0)


@pytest.mark.parametrize("bound", ["lb", "ub", "lbA", "ubA"])
def test_a_limit_that_is_nan_is_no_limit_that_is_kept(bound: str) -> None:
    problem = problem_of(0, "kinematics", "daqp", 10)
    for name, value in {"lb": -9.0, "ub": 9.0, "lbA": -9.0, "ubA": 9.0}.items():
        problem.qp[0][name][:10] = value
    assert problem.compare() == (MpcStatus.SOLVED, True)
    problem.qp[0][bound][4] = math.nan
    assert problem.compare() == (MpcStatus.INFEASIBLE, False)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("n", [2, 3, 10, 64])
def test_the_gradient_is_that_of_the_condensed_problem(n: int, model: str) -> None:
    problem = problem_of(3, model, "unconstraint_fast", n)
    qp = problem.qp
    condense_problem.call(problem.parameters, problem.state, qp)
    h, f = qp[0].H[:n, :n].copy(), qp[0].f[:n].copy()
    rng = np.random.default_rng(n)
    for size in (0.0, 0.1, 10.0):
        u = size * rng.normal(size=n)
        qp[0].u[:n] = u
        gradient_of_problem.call(problem.parameters, problem.state, qp)
        wanted = h @ u + f
        terms = np.abs(h) @ np.abs(u) + np.abs(f)
        np.testing.assert_allclose(qp[0].qp_v[:n], wanted, rtol=0, atol=1e-12 * terms.max())
        assert qp[0].qp_residual <= 3.0 * terms.max()


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("n", [2, 3, 10, 25])
def test_the_product_of_the_pivots_is_the_determinant(n: int, model: str) -> None:
    problem = problem_of(4, model, "unconstraint_fast", n)
    assert solve_recursively_alone.call(problem.parameters, problem.state, problem.qp)
    pivots = problem.state[0].pivot[:n]
    condense_problem.call(problem.parameters, problem.state, problem.qp)
    sign, logarithm = np.linalg.slogdet(problem.qp[0].H[:n, :n])
    assert sign == 1.0
    assert np.log(pivots).sum() == pytest.approx(logarithm, rel=1e-9, abs=1e-9)


def test_a_gradient_that_does_not_vanish_is_not_relied_on() -> None:
    """A weight that the recursion does not read in the same place: its answer is not proved."""
    problem = problem_of(0, "kinematics", "unconstraint_fast", 10)
    assert problem.compare() == (MpcStatus.SOLVED, True)
    lat, qp = problem.state, problem.qp
    assert solve_recursively_alone.call(problem.parameters, lat, qp)
    lat[0].r0[5] *= 1.01
    gradient_of_problem.call(problem.parameters, lat, qp)
    assert np.abs(qp[0].qp_v[:10]).max() > 1e-8 * qp[0].qp_residual


@pytest.mark.parametrize("name", ["firmware", "default"])
def test_the_shipped_sets_are_solved_alike(name: str) -> None:
    """Every tick of a drive with the weights of a shipped set."""
    weights = vars(params.load_set(name).lateral)
    chosen = {key: value for key, value in weights.items() if key.startswith("mpc_")}
    ways = []
    for seed, solver in enumerate(SOLVERS * 3):
        rig = random_rig(seed, "kinematics", qp_solver_type=solver, **chosen)
        for _ in rig.ticks(4):
            status, is_free = Problem(rig).compare()
            assert status is MpcStatus.SOLVED
            ways.append(is_free)
    assert True in ways
