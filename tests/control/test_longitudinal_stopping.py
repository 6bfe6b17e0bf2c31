# SPDX-License-Identifier: Apache-2.0
"""The STOPPING state: smooth stop as a part of the tick."""

from __future__ import annotations

import pytest

from safety_island.control.status import LongitudinalState, SmoothStopMode
from tests.control.longitudinal_rig import PERIOD, rig_in

DRIVE, STOPPING, STOPPED, EMERGENCY = LongitudinalState


def test_smooth_stop_starts_with_the_predicted_speed_and_distance() -> None:
    """0.6 m/s gives 0.498 after the delay: 0.498^2 / 2 (0.4 - 0.5 * 1.098 * 0.17) = 0.404."""
    rig = rig_in(DRIVE, smooth_stop_max_strong_acc=-0.1)
    trace = rig.tick(x=9.6, vx=0.6, ax=-0.6)
    assert (trace.lon_state, trace.smooth_stop_mode) == (STOPPING, SmoothStopMode.STRONG)
    expected = -(0.498**2) / (2 * (0.4 - 0.5 * 1.098 * 0.17))
    assert trace.acc_acc_limited == pytest.approx(expected, abs=1e-12)
    assert rig.velocity == 0.0
    assert rig.s.commands_n == 0


@pytest.mark.parametrize(
    ("x", "mode", "acc"),
    [(10.6, SmoothStopMode.STRONG_STOP, -3.4), (10.4, SmoothStopMode.WEAK_STOP, -0.8)],
)
def test_past_the_stop_point_it_brakes_by_distance(x: float, mode: int, acc: float) -> None:
    trace = rig_in(DRIVE).tick(x=x, vx=0.3)
    assert (trace.smooth_stop_mode, trace.acc_acc_limited) == (mode, acc)
    assert trace.acc_jerk_limited == pytest.approx(max(acc, -5.0 * PERIOD), abs=1e-12)


def test_at_rest_it_brakes_weakly_for_half_a_second_then_strongly() -> None:
    """It never ran, so it does not count as stopped."""
    rig = rig_in(DRIVE)
    traces = [rig.tick(x=9.8).copy() for _ in range(6)]
    assert [trace.lon_state for trace in traces] == [STOPPING] * 6
    assert [trace.acc_acc_limited for trace in traces] == [-0.3] * 4 + [-3.4] * 2
