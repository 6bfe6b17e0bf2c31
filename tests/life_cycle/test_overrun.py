# SPDX-License-Identifier: Apache-2.0
"""Late ticks in a row and a mean period that is too long, each at its boundary."""

from __future__ import annotations

from dataclasses import replace

from tests.life_cycle.kernels import Overrun
from tests.life_cycle.parameters import PARAMETERS

T = 0.125
PARAMS = replace(PARAMETERS, overrun_ticks=3, overrun_window=4, overrun_ratio=0.5)
"""The mean of four periods may be 0.25 s at most."""


def run(overrun: Overrun, *skipped: int, period_s: float = T) -> list[tuple[int, bool, bool]]:
    """Tick with these numbers of missed ticks; a grid is kept whatever they are."""
    found = []
    for i, missed in enumerate(skipped):
        overrun.tick(i * period_s, missed)
        found.append((overrun.in_row, overrun.degraded, overrun.over))
    return found


def test_at_first_all_is_well() -> None:
    overrun = Overrun(PARAMS, T)
    assert (overrun.in_row, overrun.degraded, overrun.over) == (0, False, False)


def test_three_in_a_row_degrade_and_three_more_end_the_output() -> None:
    assert run(Overrun(PARAMS, T), 0, 1, 2, 1, 1, 1, 5) == [
        (0, False, False),
        (1, False, False),
        (2, False, False),
        (3, True, False),
        (4, True, False),
        (5, True, False),
        (6, True, True),
    ]


def test_one_late_tick_may_be_enough_for_each() -> None:
    overrun = Overrun(replace(PARAMS, overrun_ticks=1), T)
    assert run(overrun, 1, 1) == [(1, True, False), (2, True, True)]


def test_one_tick_in_time_forgives() -> None:
    found = run(Overrun(PARAMS, T), 1, 1, 0, 1, 1, 1, 1, 1, 0, 1)
    assert [state[0] for state in found] == [1, 2, 0, 1, 2, 3, 4, 5, 0, 1]
    assert [state[1] for state in found] == [False] * 5 + [True] * 3 + [False] * 2
    assert not any(state[2] for state in found)


def test_after_the_end_ticks_in_time_are_well_again() -> None:
    found = run(Overrun(PARAMS, T), *[1] * 6, 0)
    assert found[-2:] == [(6, True, True), (0, False, False)]


def test_a_mean_period_at_the_limit_is_no_overrun() -> None:
    found = run(Overrun(PARAMS, T), *[0] * 12, period_s=0.25)
    assert found == [(0, False, False)] * 12


def test_a_mean_period_above_the_limit_degrades_and_then_ends_the_output() -> None:
    found = run(Overrun(PARAMS, T), *[0] * 8, period_s=0.2500001)
    assert [state[1] for state in found] == [False] * 4 + [True] * 4  # a window must be full
    assert [state[2] for state in found] == [False] * 7 + [True]


def test_the_mean_is_over_the_window_alone() -> None:
    overrun = Overrun(PARAMS, T)
    times = [0.0, 1.0, 1.125, 1.25, 1.375, 1.5]
    found = []
    for now in times:
        overrun.tick(now, 0)
        found.append(overrun.degraded)
    assert found == [False, False, False, False, True, False]


def test_to_forget_is_to_begin_anew() -> None:
    overrun = Overrun(PARAMS, T)
    run(overrun, *[1] * 6)
    overrun.forget()
    assert (overrun.in_row, overrun.degraded, overrun.over) == (0, False, False)
    assert run(overrun, 1, 1, 1, 1)[-1] == (4, True, False)
    overrun.forget()
    run(overrun, 0, 0, 0, 0, period_s=10.0)
    assert not overrun.degraded  # four times make no window of four periods
