# SPDX-License-Identifier: Apache-2.0
"""The steering predictor: a first-order lag behind commands that take effect late."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safety_island.control.lateral_state import new_lateral_state
from safety_island.control.steering_predictor import predict_steering, store_command
from tests.control.lateral_rig import circle, on_path
from tests.golden.harness import firmware

TAU = 0.27


def state() -> Any:
    return new_lateral_state(firmware())[0]


def decay(seconds: float) -> float:
    return math.exp(-seconds / TAU)


def test_the_first_call_has_no_past() -> None:
    lat = state()
    lat.predicted = 0.5
    assert predict_steering(lat, 1000.0, TAU) == 0.5


def test_two_commands_are_too_few_to_count() -> None:
    lat = state()
    predict_steering(lat, 1000.0, TAU)
    store_command(lat, np.float32(0.5), 1000.0, 0.0)
    store_command(lat, np.float32(0.5), 1000.1, 0.0)
    assert predict_steering(lat, 1000.2, TAU) == 0.0


def test_one_command_in_force_all_the_time() -> None:
    lat = state()
    predict_steering(lat, 1000.0, TAU)
    lat.predicted = 0.2
    for i in range(3):
        store_command(lat, np.float32(0.5), 1000.0 + 0.2 * i, 0.0)
    expected = decay(0.15) * 0.2 + (1.0 - decay(0.15)) * 0.5
    assert predict_steering(lat, 1000.15, TAU) == pytest.approx(expected, abs=1e-12)


def test_each_command_counts_for_its_share_of_the_interval() -> None:
    """In force: 0.1 from 0.0 s, 0.3 from 0.1 s, 0.6 from 0.2 s; earlier ones do not decay."""
    lat = state()
    for i, angle in enumerate((0.1, 0.3, 0.6)):
        store_command(lat, np.float32(angle), 1000.0 + 0.1 * i, 0.0)
    predict_steering(lat, 1000.05, TAU)
    lat.predicted = -0.4
    expected = decay(0.2) * -0.4
    for share, angle in ((0.05, 0.1), (0.1, 0.3), (0.05, 0.6)):
        expected += (1.0 - decay(share)) * float(np.float32(angle))
    assert predict_steering(lat, 1000.25, TAU) == pytest.approx(expected, abs=1e-12)


def test_commands_take_effect_after_the_delay() -> None:
    """In force from 0.3 s, 0.4 s and 0.5 s on; before that the oldest one that is known."""
    lat = state()
    predict_steering(lat, 1000.0, TAU)
    for i, angle in enumerate((0.125, 0.25, 0.5)):
        store_command(lat, np.float32(angle), 1000.0 + 0.1 * i, 0.3)
    first = (1.0 - decay(0.35)) * 0.125
    assert predict_steering(lat, 1000.35, TAU) == pytest.approx(first, abs=1e-12)
    second = decay(0.1) * first + (1.0 - decay(0.05)) * 0.125 + (1.0 - decay(0.05)) * 0.25
    assert predict_steering(lat, 1000.45, TAU) == pytest.approx(second, abs=1e-12)


def test_when_all_commands_lie_before_the_last_call_none_counts() -> None:
    lat = state()
    for i in range(3):
        store_command(lat, np.float32(0.5), 1000.0 + 0.1 * i, 0.0)
    predict_steering(lat, 1000.5, TAU)
    lat.predicted = 0.4
    assert predict_steering(lat, 1000.6, TAU) == pytest.approx(decay(0.1) * 0.4, abs=1e-12)


@pytest.mark.parametrize("nanoseconds", [-0.4e-9, 0.0, 0.4e-9])
def test_the_last_bit_of_a_stamp_decides_nothing(nanoseconds: float) -> None:
    """A command of the very time of the last call is in force from then on."""
    lat = state()
    for i, angle in enumerate((0.1, 0.3, 0.6)):
        store_command(lat, np.float32(angle), 1000.0 + 0.25 * i, 0.0)
    predict_steering(lat, 1000.25 + nanoseconds, TAU)
    lat.predicted = 0.0
    expected = (1.0 - decay(0.2)) * float(np.float32(0.3))
    assert predict_steering(lat, 1000.45, TAU) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize(("period", "kept"), [(0.15, 5), (0.03, 20), (0.4, 3)])
def test_it_remembers_three_tenths_of_a_second_and_the_delay(period: float, kept: int) -> None:
    """The second command kept is at most 0.54 s older than the newest."""
    lat = state()
    for i in range(50):
        store_command(lat, np.float32(0.1), 1000.0 + period * i, 0.24)
    assert lat.predictor_n == kept
    assert list(lat.predictor_t[:kept]) == [
        1000.0 + period * (50 - kept + i) + 0.24 for i in range(kept)
    ]


def test_the_memory_is_bounded_whatever_the_clock_does() -> None:
    lat = state()
    for i in range(2000):
        store_command(lat, np.float32(i), 1000.0 - 0.001 * i, 0.0)
    assert lat.predictor_n <= 256
    assert lat.predictor_u[lat.predictor_n - 1] == 1999.0
    assert math.isfinite(predict_steering(lat, 900.0, TAU))


@pytest.mark.parametrize("back", [1e-3, 3600.0, 1e9])
def test_a_clock_that_is_set_back_stops_the_prediction_for_a_while(back: float) -> None:
    lat = state()
    for i in range(5):
        predict_steering(lat, 1000.0 + 0.15 * i, TAU)
        store_command(lat, np.float32(0.5), 1000.0 + 0.15 * i, 0.0)
    before = predict_steering(lat, 1000.75, TAU)
    assert predict_steering(lat, 1000.75 - back, TAU) == before
    for i in range(300):
        predict_steering(lat, 1000.75 - back + 0.15 * i, TAU)
        store_command(lat, np.float32(0.5), 1000.75 - back + 0.15 * i, 0.0)
    assert 0.0 < lat.predicted < 2.0


def test_the_prediction_is_the_initial_state_where_that_is_wanted() -> None:
    """It converges to the command, whatever the sensor says."""
    for wanted in (False, True):
        rig = on_path(circle(30.0, 60.0), use_steer_prediction=wanted, input_delay=0.15)
        rig.steer(-0.3)
        for trace in rig.ticks(30):
            predicted = trace.predicted_steer
        assert rig.lat.x0[2] == (predicted if wanted else np.float32(-0.3))
        assert abs(predicted - rig.angle) < 0.02 * (1 + 9 * (not wanted))
