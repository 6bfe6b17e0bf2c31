# SPDX-License-Identifier: Apache-2.0
"""What every timer promises; the arithmetic of its grid has tests of its own."""

from __future__ import annotations

from itertools import pairwise

import pytest

from safety_island.errors import ConfigurationError
from tests.platform.rig import Rig

PERIOD_S = 0.02


def test_ticks_stand_on_the_grid(rig: Rig) -> None:
    timer = rig.platform.new_timer(PERIOD_S)
    ticks = [timer.wait() for _ in range(5)]
    timer.close()
    assert timer.period_ns == 20_000_000
    for before, after in pairwise(ticks):
        assert before is not None and after is not None
        assert after.due_ns - before.due_ns == (1 + after.skipped) * timer.period_ns
        assert 0 <= after.lateness_ns <= timer.period_ns // 2


def test_no_tick_comes_before_its_time(rig: Rig) -> None:
    timer = rig.platform.new_timer(PERIOD_S)
    tick = timer.wait()
    timer.close()
    assert tick is not None
    assert rig.platform.clock.monotonic_ns() >= tick.due_ns


@pytest.mark.parametrize("periods", [2.7, 5.7])
def test_missed_ticks_are_skipped_and_counted(rig: Rig, periods: float) -> None:
    timer = rig.platform.new_timer(PERIOD_S)
    first = timer.wait()
    rig.busy(periods * PERIOD_S)
    second = timer.wait()
    third = timer.wait()
    timer.close()
    assert first is not None and second is not None and third is not None
    assert second.skipped >= int(periods)
    assert timer.skipped == first.skipped + second.skipped + third.skipped
    assert timer.ticks == 3
    starts = [tick.due_ns + tick.lateness_ns for tick in (first, second, third)]
    assert starts[2] - starts[1] >= timer.period_ns // 2  # no burst


def test_a_wall_clock_step_moves_no_tick(rig: Rig) -> None:
    timer = rig.platform.new_timer(PERIOD_S)
    first = timer.wait()
    rig.platform.clock.set_wall_offset_ns(-3600 * 10**9)
    second = timer.wait()
    timer.close()
    assert first is not None and second is not None
    assert second.due_ns - first.due_ns == (1 + second.skipped) * timer.period_ns


def test_wake_ends_the_wait(rig: Rig) -> None:
    timer = rig.platform.new_timer(3600.0)
    rig.later(0.01, timer.wake)
    assert timer.wait() is None
    assert timer.ticks == 0
    timer.close()


def test_wake_before_the_wait_ends_the_next_one_only(rig: Rig) -> None:
    timer = rig.platform.new_timer(PERIOD_S)
    for _ in range(100_000):
        timer.wake()
    assert timer.wait() is None
    assert timer.wait() is not None
    timer.close()


@pytest.mark.parametrize("period", [0.0, -1.0, float("nan"), float("inf"), 1e9])
def test_an_impossible_period_is_refused(rig: Rig, period: float) -> None:
    with pytest.raises(ConfigurationError, match=r"timer period .* cannot be used"):
        rig.platform.new_timer(period)
