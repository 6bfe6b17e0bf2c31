# SPDX-License-Identifier: Apache-2.0
"""Rows, their history, rates and periods."""

from __future__ import annotations

import math

import pytest

from safety_island.messages.wire import Time
from safety_island.monitor.fields import FIELDS, Jerk, Measured, row, shortened
from safety_island.monitor.history import CHUNK, SECONDS, History
from safety_island.monitor.rates import WINDOW_S, Period, Rate
from tests.status.samples import AGES, sample


def test_a_row_has_the_values_of_the_status_under_their_names() -> None:
    measured = Measured(speed=6.4, steering=0.09, acceleration=-0.2)
    status = sample(lateral_error=0.25, tick_time=0.002)
    named = dict(zip(FIELDS, row(12.5, status, measured, -1.5), strict=True))
    assert named["t"] == 12.5
    assert named["lateral_error"] == pytest.approx(0.25)
    assert named["tick_time"] == pytest.approx(0.002)
    assert (named["speed"], named["steering"], named["acceleration"]) == measured
    assert named["jerk"] == -1.5
    assert named["odometry_age"] == pytest.approx(AGES[1])
    assert (named["state"], named["longitudinal_state"]) == (
        status.state,
        status.longitudinal_state,
    )


def test_what_is_sent_is_rounded_and_has_no_number_that_json_has_not() -> None:
    assert shortened([1.23456, math.nan, math.inf, 0.123456789]) == [1.235, None, None, 0.123457]


def test_jerk_is_the_change_from_command_to_command() -> None:
    jerk = Jerk()
    first = sample(command_acceleration=1.0)
    second = sample(command_acceleration=0.5)._replace(stamp=Time(1_700_000_000, 100_000_000))
    assert math.isnan(jerk.next(first))
    assert jerk.next(second) == pytest.approx(-5.0, rel=1e-4)
    assert math.isnan(jerk.next(second)), "no time has passed"
    assert math.isnan(jerk.next(sample(command_acceleration=math.nan)))
    assert math.isnan(jerk.next(second)), "the command before it is missing"


def numbered(t: float) -> list[float]:
    return [t, *([0.0] * (len(FIELDS) - 1))]


def times(history: History) -> list[float | None]:
    return [values[0] for chunk in history.chunks() for values in chunk]


def test_history_keeps_the_newest_rows_in_order() -> None:
    history = History(most_rows=4)
    assert times(history) == []
    for t in range(6):
        history.add(numbered(t))
    assert times(history) == [2.0, 3.0, 4.0, 5.0]


def test_history_goes_ten_minutes_back_in_pieces() -> None:
    history = History()
    for t in range(int(SECONDS) + 3000):
        history.add(numbered(t))
    found = times(history)
    assert (found[0], found[-1]) == (2999.0, SECONDS + 2999.0)
    assert max(len(chunk) for chunk in history.chunks()) <= CHUNK


def test_rate_of_a_counter() -> None:
    rate = Rate()
    assert rate.next(0.0, 0) is None
    for step in range(1, 100):
        found = rate.next(step * 0.2, step * 7)
    assert found == pytest.approx(35.0)
    assert rate.next(20.0, 0) is None, "a new island counts from zero"
    assert rate.next(20.0 + WINDOW_S, 8) == pytest.approx(8 / WINDOW_S)


def test_period_is_that_of_ticks_that_follow_each_other() -> None:
    period = Period()
    assert period.next(1, 0.0) is None
    for tick in range(2, 9):
        found = period.next(tick, tick * 0.03)
    assert found == pytest.approx(0.03)
    assert period.next(20, 5.0) == pytest.approx(0.03), "a gap is no period"
