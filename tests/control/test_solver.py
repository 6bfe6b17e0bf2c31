# SPDX-License-Identifier: Apache-2.0
"""The way a solver's failure takes through the lateral controller."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.control.status import MpcStatus
from tests.control.lateral_rig import Rig, line, on_path

NO_TURNING = {
    "steer_rate_lim_dps_list_by_curvature": (0.0, 0.0, 0.0),
    "steer_rate_lim_dps_list_by_velocity": (0.0, 0.0, 0.0),
}


def driving(solver: str, **overrides: object) -> Rig:
    """A vehicle beside its path, some ticks under way."""
    rig = on_path(line(60.0, v=3.0), qp_solver_type=solver, **overrides)
    rig.place(5.0, 0.3, vx=3.0)
    for _ in rig.ticks(3):
        assert rig.status is MpcStatus.SOLVED
    return rig


def check_held(rig: Rig, angle: float, status: MpcStatus) -> None:
    """The last angle with rate 0, and the reason in the trace."""
    assert rig.trace.mpc_status == rig.trace.solver_status == rig.status == status
    assert (rig.angle, rig.rate) == (angle, 0.0)
    assert not rig.follower.command["is_defined_steering_tire_rotation_rate"][0]
    assert not rig.trace.rate_limited and not rig.trace.is_steer_converged


@pytest.mark.parametrize("solver", ["daqp", "osqp"])
def test_a_problem_without_a_solution(solver: str) -> None:
    """The wheels may not turn, but the last solution is beyond the largest angle."""
    rig = driving(solver, **NO_TURNING)
    held = rig.angle
    rig.lat.raw_prev = 2.0
    rig.tick()
    check_held(rig, held, MpcStatus.INFEASIBLE)
    rig.tick()
    assert rig.status is not MpcStatus.INFEASIBLE, "the next problem starts from the sensor"
    assert math.isfinite(rig.angle)


@pytest.mark.parametrize("solver", ["unconstraint_fast", "daqp", "osqp"])
@pytest.mark.parametrize(
    ("weights", "status"),
    [
        ({"mpc_weight_lat_error": math.nan}, MpcStatus.INVALID_MATRIX),
        ({"mpc_weight_lat_error": math.inf}, MpcStatus.INVALID_MATRIX),
        ({"mpc_weight_steering_input": -50.0}, MpcStatus.NOT_POSITIVE_DEFINITE),
    ],
)
def test_a_poisoned_matrix(solver: str, weights: dict[str, float], status: MpcStatus) -> None:
    rig = driving(solver)
    twin = driving(solver)
    held = rig.angle
    good = {name: float(rig.follower._params[0][name]) for name in weights}
    for name, value in weights.items():
        rig.follower._params[0][name] = value
    with np.errstate(invalid="ignore"):  # which plain Python would warn of
        rig.tick()
    if solver == "osqp" and status is MpcStatus.NOT_POSITIVE_DEFINITE:
        status = MpcStatus.SOLVER_ERROR  # OSQP finds it in its own way
    check_held(rig, held, status)
    for name, value in good.items():
        rig.follower._params[0][name] = value
    for _ in range(3):
        rig.tick()
        twin.tick()
        assert rig.status is MpcStatus.SOLVED
    np.testing.assert_allclose(rig.trace.u, twin.trace.u, rtol=0, atol=1e-9)


@pytest.mark.parametrize("solver", ["unconstraint_fast", "daqp"])
def test_a_problem_without_weights_is_singular(solver: str) -> None:
    """The firmware gives up below a determinant of 1e-9; so do we, for each solver of our own."""
    rig = driving(solver)
    held = rig.angle
    for name in rig.follower._params.dtype.names or ():
        if name.startswith("mpc_weight") or name.startswith("mpc_low_curvature_weight"):
            rig.follower._params[0][name] = 0.0
    rig.tick()
    check_held(rig, held, MpcStatus.NOT_POSITIVE_DEFINITE)


@pytest.mark.parametrize("solver", ["unconstraint_fast", "daqp", "osqp"])
def test_a_solution_comes_with_its_proof(solver: str) -> None:
    rig = driving(solver)
    assert rig.trace.solver_status == MpcStatus.SOLVED
    assert 0.0 <= rig.trace.residual <= 1e-8


def test_all_solvers_agree_where_no_limit_is_near() -> None:
    rigs = [driving(solver) for solver in ("unconstraint_fast", "daqp", "osqp")]
    for rig in rigs[1:]:
        assert rig.trace.active_constraints == 0
        np.testing.assert_allclose(rig.trace.u, rigs[0].trace.u, rtol=0, atol=1e-9)
