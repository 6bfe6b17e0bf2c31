# SPDX-License-Identifier: Apache-2.0
"""The judgement: tolerances, what is compared, which tick is named first."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from safety_island.guard import Limit
from safety_island.guard import Verdict as GuardVerdict
from safety_island.messages.status import NO_VALUE
from safety_island.replay.check import Table
from safety_island.replay.compare import judge
from safety_island.replay.guard_acts import GUARD_COLUMNS, LIMITS, VERDICT
from safety_island.replay.recording import CONTRACT_COLUMNS, Recording

ANGLE, RATE = "steering_tire_angle", "steering_tire_rotation_rate"
TICKS = 6


def run(solver: str = "unconstraint_fast", **columns: Any) -> Recording:
    """A recording of six ticks, of which only what is compared is filled."""
    output: dict[str, Table] = {name: np.zeros(TICKS) for name in CONTRACT_COLUMNS}
    output |= {"published": np.ones(TICKS), "is_steer_converged": np.zeros(TICKS)}
    output |= {"t": np.arange(1000.0, 1000.0 + TICKS)}
    output |= {name: np.array(values, float) for name, values in columns.items()}
    none = np.zeros((0, 0))
    return Recording(
        path=Path("/recordings/scenario/run.npz"),
        state={"t": output["t"]},
        output=output,
        deliver_mask=np.full(TICKS, 15),
        traj_select=none,
        path_points=none,
        path_offsets=np.zeros(1, np.int64),
        overrides={"qp_solver_type": solver},
    )


def replayed(recording: Recording, **changes: tuple[int, float]) -> dict[str, Table]:
    """The recording's own columns, with (tick, difference) added to some; the guard passed all."""
    columns = {name: values.copy() for name, values in recording.output.items()}
    columns |= {name: np.zeros(TICKS) for name in GUARD_COLUMNS}
    for name, (tick, difference) in changes.items():
        columns[name][tick] += difference
    return columns


def osqp(polish: list[int], **columns: Any) -> Recording:
    return run("osqp", qp_polish=polish, mpc_solved=[1] * TICKS, **columns)


def test_what_is_the_same_passes() -> None:
    verdict = judge(run(), replayed(run()))
    assert verdict.passed and verdict.exceeding is None
    assert (verdict.name, verdict.ticks, verdict.loose_ticks) == ("scenario/run", TICKS, 0)
    assert verdict.greatest == dict.fromkeys(CONTRACT_COLUMNS, 0.0)


@pytest.mark.parametrize(
    ("column", "limit"), [(ANGLE, 1e-6), (RATE, 1e-5), ("velocity", 1e-5), ("acceleration", 1e-5)]
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_each_column_has_its_tolerance(column: str, limit: float, sign: float) -> None:
    close = judge(run(), replayed(run(), **{column: (3, 0.99 * sign * limit)}))
    assert close.passed and close.greatest[column] == pytest.approx(0.99 * limit)
    far = judge(run(), replayed(run(), **{column: (3, 1.01 * sign * limit)}))
    assert far.exceeding is not None
    assert (far.exceeding.tick, far.exceeding.column, far.exceeding.t) == (3, column, 1003.0)
    assert far.exceeding.tolerance == limit


@pytest.mark.parametrize("column", ["published", "is_steer_converged"])
def test_flags_must_be_equal(column: str) -> None:
    verdict = judge(run(), replayed(run(), **{column: (2, -1.0)}))
    assert verdict.exceeding is not None and verdict.exceeding.column == column


def test_convergence_counts_only_where_something_was_published() -> None:
    quiet = run(published=[0, 1, 1, 1, 1, 1], is_steer_converged=[math.nan, 0, 0, 0, 0, 0])
    verdict = judge(quiet, replayed(quiet, is_steer_converged=(0, 1.0)))
    assert verdict.passed


def test_a_recording_without_that_column_is_compared_without_it() -> None:
    recording = run()
    columns = replayed(recording, is_steer_converged=(1, 1.0))
    del recording.output["is_steer_converged"]
    assert judge(recording, columns).passed


def test_nan_equals_nan_and_nothing_else() -> None:
    silent = run(published=[0] + [1] * 5, steering_tire_angle=[math.nan] + [0.0] * 5)
    assert judge(silent, replayed(silent)).passed
    columns = replayed(silent)
    columns[ANGLE][0] = 0.0
    verdict = judge(silent, columns)
    assert verdict.exceeding is not None and verdict.greatest[ANGLE] == math.inf
    columns[ANGLE][:2] = math.nan
    verdict = judge(silent, columns)
    assert verdict.exceeding is not None and verdict.exceeding.tick == 1


def test_two_infinities_differ() -> None:
    """Nothing of the kind is ever right."""
    odd = run(velocity=[math.inf] * TICKS)
    with np.errstate(invalid="ignore"):
        assert not judge(odd, replayed(odd)).passed


def test_the_first_tick_is_told_and_in_it_the_leftmost_column() -> None:
    changes = {"acceleration": (2, 1.0), "velocity": (2, 1.0), ANGLE: (4, 1.0)}
    verdict = judge(run(), replayed(run(), **changes))
    assert verdict.exceeding is not None
    assert (verdict.exceeding.tick, verdict.exceeding.column) == (2, "velocity")
    assert str(verdict.exceeding) == (
        "tick 2 (t = 1002.000 s): velocity is 1, recorded 0, tolerance 1e-05"
    )
    assert verdict.greatest[ANGLE] == 1.0


def test_a_tick_that_was_not_published_comes_before_its_numbers() -> None:
    recording = run()
    columns = replayed(recording, published=(1, -1.0))
    columns[ANGLE][1] = math.nan
    verdict = judge(recording, columns)
    assert verdict.exceeding is not None and verdict.exceeding.column == "published"


def test_polished_ticks_of_osqp_have_their_own_tolerance() -> None:
    recording = osqp([1] * TICKS)
    assert judge(recording, replayed(recording, **{ANGLE: (1, 0.9e-5), RATE: (2, 0.9e-4)})).passed
    for column, difference in ((ANGLE, 1.1e-5), (RATE, 1.1e-4), ("velocity", 1.1e-5)):
        assert not judge(recording, replayed(recording, **{column: (1, difference)})).passed


def test_an_unpolished_tick_is_held_loosely() -> None:
    """Its rate not at all; speed and acceleration as ever; convergence may differ."""
    recording = osqp([1, 1, -1, 1, 1, 1])
    loose = replayed(recording, **{ANGLE: (2, 3.9e-2), RATE: (2, 5.0)}, is_steer_converged=(2, 1.0))
    verdict = judge(recording, loose)
    assert verdict.passed and verdict.loose_ticks == 1
    for column, difference in ((ANGLE, 4.1e-2), ("acceleration", 1.1e-5), ("published", -1.0)):
        assert not judge(recording, replayed(recording, **{column: (2, difference)})).passed


def test_what_follows_an_inexact_tick_is_loose_until_both_agree() -> None:
    recording = osqp([1, -1, 1, 1, 1, 1])
    columns = replayed(recording)
    columns[ANGLE][1:4] = 1e-3
    verdict = judge(recording, columns)
    assert verdict.passed and verdict.loose_ticks == 3
    columns[ANGLE][5] = 1e-3  # tick 4 agreed, so tick 5 has no excuse
    verdict = judge(recording, columns)
    assert verdict.exceeding is not None and verdict.exceeding.tick == 5


def test_a_loose_tick_that_agrees_excuses_nothing() -> None:
    recording = osqp([1, -1, 1, 1, 1, 1])
    verdict = judge(recording, replayed(recording, **{ANGLE: (2, 1e-3)}))
    assert verdict.exceeding is not None and verdict.exceeding.tick == 2


def test_a_tick_without_a_solution_has_nothing_to_polish() -> None:
    recording = run("osqp", qp_polish=[1, 0, 0, 1, 1, 1], mpc_solved=[1, 0, 1, 1, 1, 1])
    verdict = judge(recording, replayed(recording, **{ANGLE: (1, 1e-3)}))
    assert verdict.exceeding is not None and verdict.exceeding.tick == 1
    assert judge(recording, replayed(recording, **{ANGLE: (2, 1e-3)})).passed


def test_an_osqp_run_that_does_not_tell_is_held_as_exact() -> None:
    recording = run("osqp")
    assert not judge(recording, replayed(recording, **{ANGLE: (1, 2e-6)})).passed


def test_what_the_guard_did_is_counted_by_verdict_and_limit() -> None:
    columns = replayed(run())
    columns[VERDICT][:] = [NO_VALUE, 0, 1, 1, 2, 0]
    columns[LIMITS][2:5] = [Limit.JERK, Limit.JERK | Limit.ANGLE, Limit.STALE]
    acts = judge(run(), columns).guard
    assert acts.commands == 5
    assert (acts.count(GuardVerdict.CLAMPED), acts.count(GuardVerdict.REFUSED)) == (2, 1)
    assert acts.limits() == {"JERK": 2, "ANGLE": 1, "STALE": 1}
    assert [act.tick for act in acts.acts] == [2, 3, 4] and acts.at(1) is None
    assert str(acts.at(3)) == "the guard clamped it (ANGLE, JERK)"


def test_a_guard_that_lets_everything_pass_did_nothing() -> None:
    acts = judge(run(), replayed(run())).guard
    assert (acts.commands, acts.acts, acts.limits()) == (TICKS, (), {})
