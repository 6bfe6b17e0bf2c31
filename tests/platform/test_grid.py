# SPDX-License-Identifier: Apache-2.0
"""The time grid of a timer, by hand calculation."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from safety_island.platform.grid import Grid


def test_the_first_tick_is_one_period_after_the_start() -> None:
    grid = Grid(100, 1000)
    assert grid.delay_ns(1000) == 100
    assert grid.delay_ns(1099) == 1
    assert grid.delay_ns(1100) == 0
    assert grid.take(1103) == (1100, 3, 0)
    assert grid.delay_ns(1103) == 97


def test_half_a_period_late_runs_and_more_skips() -> None:
    grid = Grid(100, 0)
    assert grid.delay_ns(150) == 0
    assert grid.take(150) == (100, 50, 0)
    assert grid.delay_ns(251) == 49  # tick 200 is lost
    assert grid.skipped == 1
    assert grid.take(300) == (300, 0, 1)


def test_a_long_pause_skips_all_that_it_covered() -> None:
    grid = Grid(100, 0)
    grid.take(100)
    assert grid.delay_ns(1_000_020) == 0
    assert grid.take(1_000_020) == (1_000_000, 20, 9998)


@given(st.lists(st.integers(0, 700), max_size=50))
def test_ticks_are_never_closer_than_half_a_period(pauses: list[int]) -> None:
    grid = Grid(100, 0)
    now, last_start, taken = 0, -100, 0
    for pause in pauses:
        now += pause
        now += grid.delay_ns(now)
        tick = grid.take(now)
        taken += 1
        assert 0 <= tick.lateness_ns <= 50
        assert now - last_start >= 50
        assert tick.due_ns == (taken + grid.skipped) * 100
        last_start = now
    assert grid.ticks == taken
