# SPDX-License-Identifier: Apache-2.0
"""Smooth stop: the choice of braking over the last half metre."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from safety_island.control.longitudinal_state import LONGITUDINAL_STATE
from safety_island.control.smooth_stop import (
    smooth_stop_acc,
    smooth_stop_mode,
    smooth_stop_start,
    time_to_stop,
)
from safety_island.control.status import SmoothStopMode
from tests.control.longitudinal_rig import packed

NOW = 50.0
STRONG, WEAK = SmoothStopMode.STRONG, SmoothStopMode.WEAK
WEAK_STOP, STRONG_STOP = SmoothStopMode.WEAK_STOP, SmoothStopMode.STRONG_STOP


def stopping(stop_dist: float = 0.0, speeds: tuple[tuple[float, float], ...] = ()) -> Any:
    """A state with a stop distance and a history of (age, speed)."""
    state = np.zeros(1, LONGITUDINAL_STATE)
    state[0].stop_dist = stop_dist
    state[0].speeds_n = len(speeds)
    for i, (age, speed) in enumerate(speeds):
        state[0].speeds_t[i] = NOW - age
        state[0].speeds_v[i] = speed
    return state[0]


@pytest.fixture(scope="module")
def p() -> Any:
    return packed(smooth_stop_max_strong_acc=-0.5, smooth_stop_min_strong_acc=-1.0)[0]


@pytest.mark.parametrize(
    ("v", "acc"), [(0.5, -0.5), (1.0, -0.5), (1.1, -0.605), (1.3, -0.845), (2**0.5, -1.0), (3, -1)]
)
def test_strong_braking_just_reaches_the_stop_point(p: Any, v: float, acc: float) -> None:
    s = stopping()
    smooth_stop_start(p, s, v, 1.0, NOW)
    assert smooth_stop_acc(p, s, STRONG) == pytest.approx(acc, abs=1e-15)
    assert s.weak_time == NOW


@pytest.mark.parametrize("distance", [0.0, -3.0, 1e-16])
def test_at_the_stop_point_strong_braking_is_the_strongest(p: Any, distance: float) -> None:
    s = stopping()
    smooth_stop_start(p, s, 0.0, distance, NOW)
    assert s.strong_acc == -1.0


@pytest.mark.parametrize(
    ("stop_dist", "mode", "acc"),
    [(-0.51, STRONG_STOP, -3.4), (-0.5, WEAK_STOP, -0.8), (-0.31, WEAK_STOP, -0.8)],
)
def test_past_the_stop_point_the_distance_decides(
    p: Any, stop_dist: float, mode: int, acc: float
) -> None:
    s = stopping(stop_dist)
    assert smooth_stop_mode(p, s, 0.0, 0.0, NOW) == mode
    assert smooth_stop_acc(p, s, mode) == acc


def test_at_rest_it_brakes_weakly_for_half_a_second_then_strongly(p: Any) -> None:
    s = stopping()
    smooth_stop_start(p, s, 0.0, 1.0, NOW)
    assert smooth_stop_mode(p, s, 0.01, -0.01, NOW) == WEAK
    assert smooth_stop_acc(p, s, WEAK) == -0.3
    assert smooth_stop_mode(p, s, 0.0, 0.0, NOW + 0.49) == WEAK
    assert smooth_stop_mode(p, s, 0.0, 0.0, NOW + 0.5) == STRONG_STOP


@pytest.mark.parametrize(("v", "ax"), [(0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02)])
def test_motion_restarts_the_half_second(p: Any, v: float, ax: float) -> None:
    s = stopping()
    smooth_stop_start(p, s, 0.0, 1.0, NOW)
    assert smooth_stop_mode(p, s, v, ax, NOW + 2.0) == WEAK
    assert s.weak_time == NOW + 2.0
    assert smooth_stop_mode(p, s, 0.0, 0.0, NOW + 2.4) == WEAK


def test_without_an_estimate_only_a_fast_vehicle_brakes_strongly(p: Any) -> None:
    s = stopping()
    assert smooth_stop_mode(p, s, 0.51, 0.0, NOW) == STRONG
    assert s.weak_time == 0.0, "strong braking leaves the timer"
    assert smooth_stop_mode(p, s, 0.5, 0.0, NOW) == WEAK


@pytest.mark.parametrize(("seconds", "mode"), [(0.96, WEAK), (0.98, STRONG)])
def test_a_late_stop_is_braked_strongly(p: Any, seconds: float, mode: int) -> None:
    """The limit is 0.8 s and the delay of 0.17 s; the speed falls by 0.1 m/s each second."""
    s = stopping(speeds=((0.2, (seconds + 0.2) / 10), (0.1, (seconds + 0.1) / 10)))
    assert time_to_stop(s, NOW) == pytest.approx(seconds, abs=1e-12)
    assert smooth_stop_mode(p, s, 0.1, 0.0, NOW) == mode


@pytest.mark.parametrize(
    "speeds",
    [
        (),
        ((0.1, 3.0),),  # one sample: no slope
        ((0.1, 3.0), (0.1, 2.0)),  # one time
        ((0.2, 3.0), (0.1, 3.0)),  # constant: a is zero
        ((0.2, 1.0), (0.1, 2.0)),  # getting faster: zero lies in the past
    ],
)
def test_no_estimate(speeds: tuple[tuple[float, float], ...]) -> None:
    assert time_to_stop(stopping(speeds=speeds), NOW) == 0.0


def test_the_line_is_the_least_squares_one() -> None:
    """Through (-3, 4), (-2, 2), (-1, 3): slope -1/2 about (-2, 3), so zero at t = 4."""
    s = stopping(speeds=((3.0, 4.0), (2.0, 2.0), (1.0, 3.0)))
    assert time_to_stop(s, NOW) == pytest.approx(4.0, abs=1e-12)
