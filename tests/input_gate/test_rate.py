# SPDX-License-Identifier: Apache-2.0
"""Whether an input comes as often as it should."""

from __future__ import annotations

import pytest

from safety_island.input_gate.rate import LOWEST_SHARE, WINDOW, RateMeter

T = 0.125


def meter(*looks: tuple[int, float]) -> RateMeter:
    """Return a meter for a sample each T that was told of these totals, at these times [s]."""
    made = RateMeter(1.0 / T)
    for received, now in looks:
        made.look(received, now)
    return made


def test_ninety_per_cent_over_a_hundred_samples() -> None:
    assert (WINDOW, LOWEST_SHARE) == (100, 0.9)


@pytest.mark.parametrize(("share", "low"), [(1.0, False), (0.9001, False), (0.8999, True)])
@pytest.mark.parametrize("count", [100, 250])
def test_the_share_that_counts(share: float, low: bool, count: int) -> None:
    assert meter((5, 10.0), (5 + count, 10.0 + count * T / share)).too_low is low


def test_the_share_itself_is_not_too_low() -> None:
    longest_s = WINDOW * (1.0 / (LOWEST_SHARE / T))
    assert not meter((1, 0.0), (1 + WINDOW, longest_s)).too_low


def test_less_than_a_hundred_say_nothing() -> None:
    found = meter((1, 0.0), (100, 99 * 2 * T))
    assert not found.too_low
    found.look(101, 100 * 2 * T)
    assert found.too_low


def test_the_time_before_the_first_sample_does_not_count() -> None:
    assert not meter((0, 0.0), (0, 500.0), (1, 1000.0), (101, 1000.0 + 100 * T)).too_low


def test_the_next_window_says_anew() -> None:
    found = meter((1, 0.0), (101, 100 * 2 * T))
    found.look(200, 100 * 2 * T + 99 * T)
    assert found.too_low
    found.look(201, 100 * 2 * T + 100 * T)
    assert not found.too_low


def test_a_window_begins_where_the_last_one_ended() -> None:
    found = meter((1, 0.0), (101, 100 * T))
    found.look(201, 100 * T + 100 * 2 * T)
    assert found.too_low


def test_where_any_rate_will_do() -> None:
    found = RateMeter(None)
    found.look(1, 0.0)
    found.look(1000, 1e6)
    assert not found.too_low
