# SPDX-License-Identifier: Apache-2.0
"""The steering offset: learnt while driving, taken from the sensor, given to the command."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safety_island.control.status import MpcStatus
from tests.control.lateral_rig import Rig, line, on_path

WHEELBASE = 2.74
BIAS = float(np.float32(0.0125))


def rig_with(**overrides: Any) -> Rig:
    """Straight ahead at 10 m/s with estimation over four samples."""
    settings = {
        "steering_offset_enable_auto_steering_offset_removal": True,
        "steering_offset_update_vel_threshold": 5.56,
        "steering_offset_update_steer_threshold": 0.035,
        "steering_offset_steering_offset_limit": 0.02,
        "steering_offset_average_num": 4,
    }
    rig = on_path(line(200.0, v=10.0), **(settings | overrides))
    rig.place(20.0, vx=10.0)
    rig.steer(BIAS)
    return rig


def test_the_estimate_rises_as_the_zeros_leave_the_storage() -> None:
    rig = rig_with()
    offsets = [trace.steering_offset for trace in rig.ticks(6)]
    assert offsets == pytest.approx([BIAS / 4, BIAS / 2, BIAS * 0.75, BIAS, BIAS, BIAS], abs=1e-15)


def test_the_oldest_sample_leaves_first() -> None:
    rig = rig_with(steering_offset_average_num=3)
    found = []
    for sample in (0.001, 0.002, 0.004, 0.008, 0.016):
        rig.steer(sample)
        found.append(rig.tick().steering_offset * 3)
    assert found == pytest.approx([0.001, 0.003, 0.007, 0.014, 0.028], abs=1e-8)


def test_the_measurement_loses_the_estimate_of_before_and_the_command_gains_the_new_one() -> None:
    rig = rig_with()
    previous = 0.0
    for trace in rig.ticks(5):
        assert rig.lat.measured == np.float32(BIAS - previous)
        assert rig.lat.x0[2] == rig.lat.measured
        solution = np.float32(trace.u[0])  # the low pass lets it through
        assert rig.angle == np.float32(solution + trace.steering_offset)
        assert rig.lat.history_u[rig.lat.history_n - 1] == solution, "what was wanted of the tyre"
        previous = trace.steering_offset
    assert previous == pytest.approx(BIAS)


def test_a_biased_sensor_ends_as_a_straight_drive() -> None:
    """The command then holds the sensor's zero, which is where the tyre points ahead."""
    rig = rig_with()
    for _ in range(8):
        rig.tick()
    assert rig.lat.measured == pytest.approx(0.0, abs=1e-8)
    assert rig.angle == pytest.approx(BIAS, abs=1e-6)
    assert rig.trace.raw_steer_cmd_prev == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("speed", [10.0, -10.0])
@pytest.mark.parametrize("turn", [0.02, -0.015])
def test_the_angle_of_a_turn_is_no_offset_forward_or_in_reverse(speed: float, turn: float) -> None:
    """The yaw rate tells the true angle; the sensor shows it with the bias."""
    rig = rig_with(steering_offset_average_num=1)
    rig.place(20.0, vx=speed, wz=speed * math.tan(turn) / WHEELBASE)
    rig.steer(turn + BIAS)
    assert rig.tick().steering_offset == pytest.approx(BIAS, abs=1e-8)


@pytest.mark.parametrize("bias", [0.03, -0.03])
def test_the_estimate_stays_within_its_limit(bias: float) -> None:
    rig = rig_with(steering_offset_average_num=1)
    rig.steer(bias)
    assert rig.tick().steering_offset == math.copysign(0.02, bias)


@pytest.mark.parametrize(
    ("speed", "angle", "learns"),
    [
        (5.57, 0.01, True),
        (5.56, 0.01, False),
        (-5.57, 0.01, True),
        (-5.56, 0.01, False),
        (10.0, 0.0349, True),
        (10.0, 0.0351, False),
        (10.0, -0.0351, False),
        (0.0, 0.01, False),
    ],
)
def test_only_a_fast_and_nearly_straight_drive_teaches(
    speed: float, angle: float, learns: bool
) -> None:
    rig = rig_with(steering_offset_average_num=1)
    rig.place(20.0, vx=speed)
    rig.steer(angle)
    assert (rig.tick().steering_offset != 0.0) == learns


def test_a_failed_tick_teaches_but_holds_the_output() -> None:
    rig = rig_with()
    rig.tick()
    held = rig.angle
    rig.place(20.0, 8.0, vx=10.0)
    trace = rig.tick()
    assert rig.status is MpcStatus.TOO_FAR
    assert trace.steering_offset == pytest.approx(BIAS / 2)
    assert rig.angle == held


def test_it_is_off_unless_asked_for() -> None:
    rig = rig_with(steering_offset_enable_auto_steering_offset_removal=False)
    assert rig.tick().steering_offset == 0.0
    assert rig.lat.measured == np.float32(BIAS)


def test_a_speed_threshold_of_zero_divides_by_no_zero() -> None:
    rig = rig_with(steering_offset_update_vel_threshold=0.0, steering_offset_average_num=1)
    rig.place(20.0, vx=0.0, wz=0.5)
    assert rig.tick().steering_offset == 0.0
    rig.place(20.0, vx=5e-324, wz=0.5)
    assert abs(rig.tick().steering_offset) <= 0.02
