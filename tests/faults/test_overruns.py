# SPDX-License-Identifier: Apache-2.0
"""Rows 43 to 46 of the fault catalogue: ticks that come or end too late."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from itertools import pairwise, takewhile
from random import Random
from typing import Any

import pytest

from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.faults.checks import BOTH, rearms, stays_active, stays_latched
from tests.faults.hands import run
from tests.faults.scene import SLOW, Scene

LATE = 1.6
"""Periods that a tick takes which makes the next one miss its place."""


def take(scene: Scene, seconds: Iterator[float]) -> None:
    """Let the controllers take so much time [s] in each of the next ticks."""
    run = scene.follower.run_lateral

    def slow(now: float) -> Any:
        scene.idle(next(seconds, 0.0))
        return run(now)

    scene.follower.run_lateral = slow  # type: ignore[method-assign]


@BOTH
def test_row_43_a_late_tick_is_skipped_not_bunched(period_s: float) -> None:
    scene = Scene(period_s).drive()
    take(scene, iter([0.0, LATE * period_s]))
    rows = run(scene, 20 * period_s)
    assert {(row.state, row.output) for row in rows} == {(State.ACTIVE, "published")}
    assert [row.skipped for row in rows[:4]] == [0, 0, 1, 0]
    steps = [round((b.at - a.at) / period_s, 3) for a, b in pairwise(rows)]
    assert steps[:4] == [1.0, 2.0, 1.0, 1.0]
    offset = scene.clock.wall_ns() - scene.clock.monotonic_ns()
    for row in rows:
        assert row.command is not None
        stamp = row.command.stamp.nanoseconds - offset
        assert stamp == pytest.approx(row.at * 1e9, abs=1000), "of the inputs, not of the sending"


@BOTH
def test_row_44_repeated_overruns_degrade_then_end_the_output(period_s: float) -> None:
    scene = Scene(period_s).drive()
    take(scene, iter([LATE * period_s] * 10))
    degraded: list[bool] = []
    scene.node.observers.append(
        lambda report: degraded.append(scene.node.life_cycle.overrun.degraded)
    )
    rows = run(scene, 16 * period_s)
    ticks = scene.parameters.life_cycle.overrun_ticks
    assert degraded[: ticks + 1] == [False] * ticks + [True]
    silent = next(i for i, row in enumerate(rows) if row.output == "silent")
    assert silent == 2 * ticks
    assert (rows[silent].state, rows[silent].reason) == (State.SILENT, Reason.OVERRUN)
    assert {row.output for row in rows[silent:]} == {"silent"}
    run(scene, 1.0)
    stays_latched(scene, Reason.OVERRUN)
    rearms(scene)


def test_row_44_a_mean_period_that_is_too_long_ends_the_output() -> None:
    """Every third tick is late: never three in a row, but 4/3 T in the mean."""
    scene = Scene().drive()
    take(scene, iter([0.0, 0.0, LATE * SLOW] * 60))
    rows = run(scene, 150 * SLOW)
    first = next(row for row in rows if row.output == "silent")
    window = scene.parameters.life_cycle.overrun_window
    assert first.reason is Reason.OVERRUN
    assert rows.index(first) <= window + 2 * scene.parameters.life_cycle.overrun_ticks


@BOTH
def test_row_45_a_starved_process_ends_its_output_and_recovers(
    period_s: float, random: Random
) -> None:
    """For seconds it gets the processor for moments only; at rest it may arm itself again."""
    scene = Scene(period_s).drive()
    at_s = scene.now
    while at_s < scene.now + 8.0:
        stall_s = random.uniform(2.1, 3.0) * period_s
        at_ns = round((at_s + random.uniform(0.1, 0.4) * period_s) * 1e9)
        scene.clock.call_at(at_ns, partial(scene.idle, stall_s))
        at_s = at_ns / 1e9 + stall_s
    rows = run(scene, 8.0)
    ticks = scene.parameters.life_cycle.overrun_ticks
    assert len(rows) > 3 * ticks
    moving = list(takewhile(lambda row: row.speed > 0.1, rows))
    assert {row.output for row in moving[2 * ticks + 2 :]} <= {"silent"}
    assert "silent" in {row.output for row in rows}
    run(scene, 3.0)
    if scene.rows[-1].state is State.SILENT:  # else the vehicle came to rest meanwhile
        stays_latched(scene, scene.node.life_cycle.life.cause)
        rearms(scene)
    stays_active(scene, 1.0)


@BOTH
def test_row_45_one_short_starvation_is_survived(period_s: float) -> None:
    scene = Scene(period_s).drive()
    at = scene.clock.monotonic_ns() + round(0.5 * period_s * 1e9)
    scene.clock.call_at(at, lambda: scene.idle(0.25))
    rows = run(scene, 3.0)
    assert {(row.state, row.output) for row in rows} == {(State.ACTIVE, "published")}
    assert sum(row.skipped for row in rows) == max(0, math.ceil(0.25 / period_s - 1.0))


@BOTH
def test_row_46_a_hog_of_the_interpreter_costs_no_tick(period_s: float, random: Random) -> None:
    """A thread in a loop makes ticks 5 ms late in the median, 15 ms at worst."""
    scene = Scene(period_s).drive()
    begin, period_ns = scene.clock.monotonic_ns(), round(period_s * 1e9)
    for number in range(1, 300):
        late_s = random.triangular(0.0, 0.0145, 0.005)
        scene.clock.call_at(begin + number * period_ns, partial(scene.idle, late_s))
    rows = run(scene, 290 * period_s)
    assert {(row.state, row.output) for row in rows} == {(State.ACTIVE, "published")}
    assert not any(row.skipped for row in rows)
