# SPDX-License-Identifier: Apache-2.0
"""Memories of commands and speeds, and the prediction over the delay of 0.17 s."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from safety_island.control.limits import MAX_HISTORY
from safety_island.control.longitudinal_history import (
    predict_after_delay,
    store_command,
    store_speed_last,
)
from safety_island.control.longitudinal_state import LONGITUDINAL_STATE
from safety_island.control.records import INPUTS
from safety_island.control.status import LongitudinalState, Mode
from tests.control.longitudinal_rig import packed

NOW = 1000.0
DELAY = 0.17


def fresh(state: LongitudinalState = LongitudinalState.DRIVE) -> Any:
    made = np.zeros(1, LONGITUDINAL_STATE)
    made[0].state = state
    return made[0]


@pytest.fixture(scope="module")
def p() -> Any:
    return packed()[0]


def predicted(
    p: Any, v: float, ax: float, commands: list[tuple[float, float]], mode: int = Mode.AUTONOMOUS
) -> tuple[float, float]:
    """Speed and distance after the delay; commands as (age, acceleration), oldest first."""
    s, u = fresh(), np.zeros(1, INPUTS)[0]
    u.vx, u.ax, u.mode = v, ax, mode
    for age, acc in commands:
        s.commands_stamp[s.commands_n] = NOW - age
        s.commands_acc[s.commands_n] = acc
        s.commands_n += 1
    predict_after_delay(p, u, s, NOW)
    return float(s.pred_vel), float(s.pred_dist)


@pytest.mark.parametrize(
    ("v", "ax", "speed", "distance"),
    [
        (2.0, 0.0, 2.0, 0.34),
        (-2.0, 0.0, -2.0, 0.34),
        (2.0, 1.0, 2.17, 0.34 + 0.5 * DELAY**2),
        (0.1, -1.0, 0.0, 0.005),  # stands after 0.1 s
        (-0.1, 1.0, 0.0, 0.005),
        (0.0, -1.0, -0.17, 0.5 * DELAY**2),  # from rest it is not held
        (0.17, -1.0, 0.0, 0.5 * DELAY**2),  # stands at the very end
    ],
)
def test_without_commands_the_measured_acceleration_predicts(
    p: Any, v: float, ax: float, speed: float, distance: float
) -> None:
    assert predicted(p, v, ax, []) == pytest.approx((speed, distance), abs=1e-12)


@pytest.mark.parametrize(("mode", "speed"), [(2, 1.85), (1, 2.17), (3, 2.17)])
def test_commands_count_in_autonomous_mode_only(p: Any, mode: int, speed: float) -> None:
    assert predicted(p, 2.0, 1.0, [(0.15, -1.0)], mode)[0] == pytest.approx(speed, abs=1e-12)


def test_each_command_lasts_until_the_next_and_the_last_until_now(p: Any) -> None:
    """1 m/s^2 for 0.06 s, then -2 for 0.1 s: 1.06, then 0.86 m/s."""
    speed, distance = predicted(p, 1.0, 9.0, [(0.16, 1.0), (0.1, -2.0)])
    assert speed == pytest.approx(0.86, abs=1e-12)
    assert distance == pytest.approx(0.06 + 0.0018 + 0.106 - 0.01, abs=1e-12)


def test_old_commands_are_skipped_and_young_ones_count_with_their_whole_step(p: Any) -> None:
    """The first is older than the delay; the other two together last 0.16 s."""
    speed, _ = predicted(p, 1.0, 0.0, [(0.31, 9.0), (0.16, 1.0), (0.01, 3.0)])
    assert speed == pytest.approx(1.0 + 0.15 + 0.03, abs=1e-7)
    assert predicted(p, 1.0, 5.0, [(0.3, 9.0)]) == (1.0, 0.0), "all old: no motion at all"


def test_a_step_is_not_longer_than_the_delay(p: Any) -> None:
    """The clock of the second stamp lies ahead."""
    speed, _ = predicted(p, 1.0, 0.0, [(0.1, 1.0), (-0.4, 0.0)])
    assert speed == pytest.approx(1.17, abs=1e-12)


def test_in_reverse_acceleration_makes_the_speed_more_negative(p: Any) -> None:
    speed, distance = predicted(p, -1.0, 0.0, [(0.1, 2.0)])
    assert speed == pytest.approx(-1.2, abs=1e-12)
    assert distance == pytest.approx(0.11, abs=1e-12)


@pytest.mark.parametrize("v", [0.1, -0.1])
def test_a_change_of_direction_ends_at_standstill(p: Any, v: float) -> None:
    """Both steps would count, but the first one already turns the speed round."""
    speed, distance = predicted(p, v, 0.0, [(0.16, -2.0), (0.08, 1.0)])
    assert speed == 0.0
    assert distance == pytest.approx(0.1 * 0.08 - 0.0064, abs=1e-9)


def test_from_exact_standstill_any_backward_speed_is_a_change_of_direction(p: Any) -> None:
    assert predicted(p, 0.0, 0.0, [(0.1, -1.0)])[0] == 0.0
    assert predicted(p, 0.0, 0.0, [(0.1, 1.0)])[0] == pytest.approx(0.1, abs=1e-12)
    assert predicted(p, -0.0, 0.0, [(0.1, 1.0)])[0] == 0.0


def test_reaching_zero_exactly_is_no_change_of_direction(p: Any) -> None:
    speed, _ = predicted(p, 0.125, 0.0, [(0.1875, 9.0), (0.125, -1.0), (0.0, 0.0)])
    assert speed == 0.0
    speed, _ = predicted(p, 0.125, 0.0, [(0.1640625, -2.0), (0.1015625, 1.0)])
    assert speed == pytest.approx(0.1015625, abs=1e-12), "the later command still counts"


def test_commands_are_stored_rounded_and_the_oldest_goes_one_a_tick(p: Any) -> None:
    s = fresh()
    s.raw_acc = 0.1
    for i in range(9):
        store_command(p, s, NOW + 0.05 * i)
    ages = [round(NOW + 0.4 - stamp, 6) for stamp in s.commands_stamp[: s.commands_n]]
    assert ages == [0.2, 0.15, 0.1, 0.05, 0.0]
    assert s.commands_acc[0] == np.float32(0.1)
    for i in range(3):
        store_command(p, s, NOW + 1.0 + i)
    assert s.commands_n == 5


def test_stamps_are_whole_nanoseconds(p: Any) -> None:
    s = fresh()
    store_command(p, s, 0.1234567899)
    assert s.commands_stamp[0] == pytest.approx(0.123456789, abs=1e-16)


def test_any_other_state_empties_the_memory_of_commands(p: Any) -> None:
    s = fresh()
    store_command(p, s, NOW)
    s.state = LongitudinalState.STOPPING
    store_command(p, s, NOW + 0.1)
    assert s.commands_n == 0


def test_a_clock_that_stands_still_does_not_overflow_the_memories(p: Any) -> None:
    s = fresh()
    for i in range(2 * MAX_HISTORY):
        s.raw_acc = i
        store_command(p, s, NOW)
    assert s.commands_n == MAX_HISTORY
    assert s.commands_acc[MAX_HISTORY - 1] == 2 * MAX_HISTORY - 1


@pytest.mark.parametrize(
    ("period", "delay", "kept"),
    [(0.15, 0.17, 1), (0.03, 0.17, 5), (0.2, 0.17, 0), (0.01, 9.0, MAX_HISTORY)],
)
def test_speeds_are_kept_by_count(period: float, delay: float, kept: int) -> None:
    p, s = packed(ctrl_period=period, delay_compensation_time=delay)[0], fresh()
    for i in range(MAX_HISTORY + 9):
        store_speed_last(p, s, -0.5 * i, NOW + i)
    assert s.speeds_n == kept
    newest = MAX_HISTORY + 8
    assert list(s.speeds_v[:kept]) == [-0.5 * i for i in range(newest - kept + 1, newest + 1)]
    assert kept == 0 or s.speeds_t[kept - 1] == NOW + newest
