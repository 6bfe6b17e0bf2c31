# SPDX-License-Identifier: Apache-2.0
"""Rows 38 to 42 of the fault catalogue: a solver that finds nothing, or something wrong."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

from safety_island.control.lateral import lateral_finish, lateral_prepare
from safety_island.control.qp import MAX_ITERATIONS
from safety_island.control.qp_alone import check_problem, solve_problem
from safety_island.control.status import MpcStatus
from safety_island.kernel.records import Records
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.faults.checks import BOTH, recovers, silent_within, stays_active
from tests.faults.scene import SLOW, Scene

Tamper = Callable[[Any, int], MpcStatus]
"""Given the solved problem and its size; SOLVED lets the island's own check decide."""


def tamper_with(scene: Scene, tamper: Tamper) -> None:
    """Put a function between the solver and the check of its solution."""
    for kernel in (lateral_prepare, lateral_finish, solve_problem, check_problem):
        kernel.prepare()

    def solve(qp: Records, n: int) -> MpcStatus:
        status = MpcStatus(solve_problem.call(qp, n, MAX_ITERATIONS))
        if status is MpcStatus.SOLVED:
            status = tamper(qp[0], n)
        return MpcStatus(check_problem.call(qp, n)) if status is MpcStatus.SOLVED else status

    scene.follower._solve = solve


def untampered(qp: Any, n: int) -> MpcStatus:
    """Leave the solution as it is."""
    return MpcStatus.SOLVED


def is_held_and_told(scene: Scene, status: MpcStatus) -> None:
    """One tick without a solution: the last angle, no rate, and a line in the log."""
    before = scene.rows[-1].command
    row = stays_active(scene, scene.period_s)[0]
    assert row.command is not None and before is not None
    assert row.command.steering_tire_angle == before.steering_tire_angle
    assert not row.command.is_defined_steering_tire_rotation_rate
    assert scene.follower.trace["mpc_status"][0] == status
    assert status.name.lower().replace("_", " ") in scene.log_text


def ends_the_output(scene: Scene) -> None:
    """Without a solution for too long the output ends; the fault gone, it can be armed again."""
    limit_s = scene.parameters.life_cycle.mpc_failure_time
    silent_within(scene, scene.now - scene.period_s, limit_s + 2 * scene.period_s)
    assert scene.node.life_cycle.life.cause is Reason.MPC_FAILED


def test_the_way_round_through_the_hook_changes_no_bit() -> None:
    """The check of the check."""
    twin, scene = Scene().drive(), Scene().drive()
    tamper_with(scene, untampered)
    assert stays_active(scene, 5.0) == stays_active(twin, 5.0)


@BOTH
def test_row_38_an_infeasible_problem_holds_the_steering(period_s: float) -> None:
    """The last raw angle is beyond the greatest one by more than a period's rate allows."""
    scene = Scene(period_s).drive()
    scene.follower._lateral["raw_prev"] = 5.0
    is_held_and_told(scene, MpcStatus.INFEASIBLE)
    stays_active(scene, 1.0)


@BOTH
@pytest.mark.parametrize(
    "status", [s for s in MpcStatus if s >= MpcStatus.INVALID_MATRIX], ids=lambda s: s.name.lower()
)
def test_row_39_a_solver_that_gives_up_holds_the_steering(
    status: MpcStatus, period_s: float
) -> None:
    """Iteration limit, and each other way to fail: one tick does no harm, many end the output."""
    scene = Scene(period_s).drive()
    tamper_with(scene, lambda qp, n: status)
    is_held_and_told(scene, status)
    tamper_with(scene, untampered)
    stays_active(scene, 1.0)
    tamper_with(scene, lambda qp, n: status)
    scene.tick()
    ends_the_output(scene)
    tamper_with(scene, untampered)
    recovers(scene, Reason.MPC_FAILED)


def test_row_39_a_solver_that_takes_too_long_gives_no_command() -> None:
    """Beyond ``timeout_thr_sec`` the command is too old to be sent, and so are the inputs then."""
    scene = Scene().drive()
    late_s = [scene.parameters.node.timeout_thr_sec + 0.02]

    def slow(qp: Any, n: int) -> MpcStatus:
        scene.idle(late_s.pop() if late_s else 0.0)
        return MpcStatus.SOLVED

    tamper_with(scene, slow)
    row = scene.tick()
    assert (row.output, row.outcome.name) == ("silent", "STALE")
    row = scene.tick()
    assert (row.state, row.reason) == (State.SILENT, Reason.INPUT_STALE)
    recovers(scene, Reason.INPUT_STALE)


@BOTH
def test_row_39_a_solver_that_takes_its_time_costs_no_command(period_s: float) -> None:
    scene = Scene(period_s).drive()

    def slow(qp: Any, n: int) -> MpcStatus:
        scene.idle(0.45 * period_s)
        return MpcStatus.SOLVED

    tamper_with(scene, slow)
    assert not any(row.skipped for row in stays_active(scene, 5.0))


def spoil(value: float, step: int) -> Tamper:
    """Write a number over one step of the solution."""

    def tamper(qp: Any, n: int) -> MpcStatus:
        qp.u[step] = value
        return MpcStatus.SOLVED

    return tamper


@pytest.mark.parametrize("step", [0, 25, 49])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_row_40_a_solution_that_is_no_number_is_discarded(value: float, step: int) -> None:
    scene = Scene().drive()
    tamper_with(scene, spoil(value, step))
    is_held_and_told(scene, MpcStatus.SOLUTION_NOT_FINITE)
    ends_the_output(scene)
    tamper_with(scene, untampered)
    recovers(scene, Reason.MPC_FAILED)


WEIGHTS = (
    "lat_error",
    "heading_error",
    "heading_error_squared_vel",
    "steering_input",
    "steering_input_squared_vel",
    "lat_jerk",
)
NO_WEIGHTS = {
    **{f"mpc_weight_{name}": 0.0 for name in (*WEIGHTS, "steer_rate", "steer_acc")},
    **{f"mpc_low_curvature_weight_{name}": 0.0 for name in WEIGHTS},
    **{f"mpc_weight_terminal_{name}": 0.0 for name in ("lat_error", "heading_error")},
}


def test_row_41_a_singular_problem_has_no_solution() -> None:
    """No weight at all: the Hessian is zero. From READY the output ends without a latch."""
    scene = Scene(overrides=NO_WEIGHTS)
    scene.tick()
    assert scene.follower.trace["mpc_status"][0] == MpcStatus.NOT_POSITIVE_DEFINITE
    silent_within(scene, scene.now - SLOW, 0.5 + 2 * SLOW)
    assert scene.rows[-1].reason is Reason.MPC_FAILED


def push(by: float) -> Tamper:
    """Move one step of the solution."""

    def tamper(qp: Any, n: int) -> MpcStatus:
        qp.u[3] += by
        return MpcStatus.SOLVED

    return tamper


@pytest.mark.parametrize("by", [1e-3, -1e-3, 1e-5])
def test_row_42_a_solution_that_is_not_the_best_is_discarded(by: float) -> None:
    scene = Scene().drive()
    tamper_with(scene, push(by))
    is_held_and_told(scene, MpcStatus.SOLUTION_NOT_OPTIMAL)
    ends_the_output(scene)


@pytest.mark.parametrize("by", [0.3, -0.3, 1.0, 1e9])
def test_row_42_a_solution_beyond_its_bounds_is_discarded(by: float) -> None:
    scene = Scene().drive()
    tamper_with(scene, push(by))
    is_held_and_told(scene, MpcStatus.SOLUTION_VIOLATES)
    ends_the_output(scene)
