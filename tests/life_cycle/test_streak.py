# SPDX-License-Identifier: Apache-2.0
"""Failures in a row, and for how long."""

from __future__ import annotations

from tests.life_cycle.kernels import Streak


def test_nothing_has_failed_yet() -> None:
    streak = Streak()
    assert (streak.count, streak.lasts_s(5.0)) == (0, 0.0)


def test_failures_count_from_the_first() -> None:
    streak = Streak()
    for i in range(1, 4):
        streak.note(True, 10.0 + i)
        assert (streak.count, streak.since, streak.lasts_s(20.0)) == (i, 11.0, 9.0)


def test_a_success_ends_it_and_the_next_begins_anew() -> None:
    streak = Streak()
    streak.note(True, 1.0)
    streak.note(False, 2.0)
    assert (streak.count, streak.lasts_s(3.0)) == (0, 0.0)
    streak.note(True, 4.0)
    assert (streak.count, streak.lasts_s(4.0), streak.lasts_s(6.0)) == (1, 0.0, 2.0)
