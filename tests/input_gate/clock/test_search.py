# SPDX-License-Identifier: Apache-2.0
"""Stamps that do not fit: a clock goes on, samples from the past do not."""

from __future__ import annotations

import math

import pytest

from safety_island.input_gate.clock.records import new_stamps
from safety_island.input_gate.clock.search import SEARCH_SHARE, finds, goes_on

NEVER = -math.inf
"""When a stamp that fits came: not at all."""

Seen = tuple[int, float]
"""Stamp [ns] and time of arrival [s]."""


class ClockSearch:
    """The search of one input with this age limit [s]."""

    def __init__(self, limit_s: float) -> None:
        self._one = new_stamps()[0]
        self._one.limit_s = limit_s

    def goes_on(self, now: float) -> bool:
        return bool(goes_on(self._one, now))

    def finds(self, stamp_ns: int, now: float, fitted_at: float) -> bool:
        self._one.stamp_ns, self._one.held_at = stamp_ns, fitted_at
        return bool(finds(self._one, now))


def found(*seen: Seen) -> list[bool]:
    search = ClockSearch(0.5)
    return [search.finds(stamp_ns, now, NEVER) for stamp_ns, now in seen]


def test_stamps_that_advance_for_half_the_limit_are_a_clock() -> None:
    assert SEARCH_SHARE == 0.5
    assert found((5, 9.0), (6, 9.125), (7, 9.25), (8, 9.375)) == [False, False, True, True]
    assert found((5, 9.0), (6, 9.2499)) == [False, False]


@pytest.mark.parametrize("second", [4, 5])
def test_one_that_does_not_advance_begins_anew(second: int) -> None:
    assert found((5, 9.0), (second, 9.25), (6, 9.375), (7, 9.5)) == [False, False, False, True]


def test_a_gap_beyond_the_limit_begins_anew() -> None:
    assert found((5, 9.0), (6, 9.5)) == [False, True]
    assert found((5, 9.0), (6, 9.5001), (7, 9.7501)) == [False, False, True]


def test_of_one_tick_the_first_alone_tells() -> None:
    assert found((5, 9.0), (4, 9.0), (3, 9.0), (6, 9.25)) == [False, False, False, True]


@pytest.mark.parametrize(("fitted_at", "is_found"), [(8.9, True), (9.0, False), (9.1, False)])
def test_one_that_fits_ends_the_search(fitted_at: float, is_found: bool) -> None:
    search = ClockSearch(0.5)
    assert not search.finds(5, 9.0, NEVER)
    assert search.finds(6, 9.25, fitted_at) is is_found
    assert search.finds(7, 9.5, fitted_at)


def test_beside_one_that_fits_in_the_same_tick_nothing_is_found() -> None:
    search = ClockSearch(0.5)
    assert not search.finds(5, 9.0, NEVER)
    assert search.finds(6, 9.25, NEVER)
    assert not search.finds(6, 9.25, 9.25)


def test_without_an_age_limit_nothing_is_ever_found() -> None:
    search = ClockSearch(math.inf)
    assert not search.finds(5, 9.0, NEVER)
    assert not search.finds(6, 1e9, NEVER)


def test_a_stamp_goes_on_from_one_of_an_earlier_tick() -> None:
    search = ClockSearch(0.5)
    assert not search.goes_on(9.0)
    search.finds(5, 9.0, NEVER)
    assert not search.goes_on(9.0)
    search.finds(6, 9.125, NEVER)
    assert search.goes_on(9.125)
    assert not search.goes_on(9.25)
    search.finds(6, 9.25, NEVER)
    assert not search.goes_on(9.25)
