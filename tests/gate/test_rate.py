"""Whether an input comes as often as it should."""

from __future__ import annotations

import pytest

from safety_island.gate.rate import LOWEST_SHARE, WINDOW, RateMeter

T = 0.125


def feed(meter: RateMeter, count: int, period_s: float = T, at: float = 0.0) -> float:
    for i in range(count):
        meter.note(1, at + i * period_s)
    return at + count * period_s


def test_ninety_per_cent_over_a_hundred_samples() -> None:
    assert (WINDOW, LOWEST_SHARE) == (100, 0.9)


@pytest.mark.parametrize(("share", "low"), [(1.0, False), (0.9001, False), (0.8999, True)])
def test_the_share_that_counts(share: float, low: bool) -> None:
    meter = RateMeter(8.0)
    feed(meter, 100, T / share)
    assert not meter.too_low  # a hundred periods need one sample more
    feed(meter, 1, at=100 * T / share)
    assert meter.too_low is low


def test_the_share_itself_is_not_too_low() -> None:
    meter = RateMeter(8.0)
    meter.note(1, 0.0)
    meter.note(WINDOW, WINDOW / (LOWEST_SHARE * 8.0) * WINDOW / WINDOW)
    assert not meter.too_low


def test_the_next_window_says_anew() -> None:
    meter = RateMeter(8.0)
    end = feed(meter, 101, 2 * T)
    assert meter.too_low
    feed(meter, 100, T, end)
    assert meter.too_low
    feed(meter, 1, T, end + 100 * T)
    assert not meter.too_low


def test_samples_that_come_together() -> None:
    meter = RateMeter(8.0)
    for tick in range(26):  # 4 * 26 = 104 > 100: 103 periods in at most 14.3 s
        meter.note(4, tick * 0.5)
    assert not meter.too_low
    slow = RateMeter(8.0)
    for tick in range(26):
        slow.note(4, tick * 0.6)
    assert slow.too_low


def test_where_any_rate_will_do() -> None:
    meter = RateMeter(None)
    feed(meter, 300, 100.0)
    assert not meter.too_low
