# SPDX-License-Identifier: Apache-2.0
"""Statistics of a run: as good as a list of all times, in memory that does not grow."""

from __future__ import annotations

import random
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety_island.cli.tick_times import LONGEST_S, SHORTEST_S, TickTimes


def nearest_rank(times: list[float], percent: float) -> float:
    ordered = sorted(times)
    return ordered[max(-(-len(ordered) * int(percent) // 100), 1) - 1]


def filled(times: list[float]) -> TickTimes:
    found = TickTimes()
    for time_s in times:
        found.add(time_s)
    return found


@given(
    st.lists(st.floats(SHORTEST_S, LONGEST_S), min_size=1, max_size=200),
    st.sampled_from([1, 50, 99, 100]),
)
def test_a_quantile_is_never_too_low_and_at_most_one_percent_too_high(
    times: list[float], percent: int
) -> None:
    exact = nearest_rank(times, percent)
    found = filled(times).quantile(percent)
    assert found is not None
    assert exact * (1 - 1e-9) <= found <= exact * 1.01 * (1 + 1e-9)


@given(st.lists(st.floats(0.0, 1e6), min_size=1))
def test_the_greatest_is_exact_and_bounds_every_quantile(times: list[float]) -> None:
    found = filled(times)
    assert found.max_s == max(times) and found.count == len(times)
    assert found.quantile(100) <= found.max_s or found.max_s > LONGEST_S  # type: ignore[operator]


def test_old_times_count_as_new_ones() -> None:
    """A window of the newest times forgot what was before."""
    found = filled([0.010] * 200_000 + [0.001] * 100_001)
    assert found.quantile(50) == pytest.approx(0.010, rel=0.011)


def test_no_time_is_no_quantile() -> None:
    assert TickTimes().quantile(50) is None


def test_memory_is_the_same_after_a_million_times() -> None:
    found = TickTimes()
    before = sys.getsizeof(found._counts)
    rng = random.Random(1)
    for _ in range(1_000_000):
        found.add(rng.expovariate(1000.0))
    assert sys.getsizeof(found._counts) == before < 20_000
    assert found.count == 1_000_000
