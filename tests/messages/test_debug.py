# SPDX-License-Identifier: Apache-2.0
"""The encoders of the debug topics against independent bytes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.messages import debug
from safety_island.messages.debug import Diagnostic
from safety_island.messages.wire import Time
from tests.messages.oracle import cyclone_bytes, rosbags_bytes
from tests.messages.strategies import FLOAT32, TEXTS, TIMES

ZERO = {"sec": 0, "nanosec": 0}
NUMBERS = st.lists(FLOAT32, max_size=60)


def control(stamp: Time, angle: float, rate: float, moves: tuple[float, float]) -> dict[str, Any]:
    stamps = {"stamp": stamp._asdict(), "control_time": ZERO}
    return {
        **stamps,
        "lateral": {
            **stamps,
            "steering_tire_angle": angle,
            "steering_tire_rotation_rate": rate,
            "is_defined_steering_tire_rotation_rate": True,
        },
        "longitudinal": {
            **stamps,
            "velocity": moves[0],
            "acceleration": moves[1],
            "jerk": 0.0,
            "is_defined_acceleration": True,
            "is_defined_jerk": False,
        },
    }


@settings(max_examples=60, deadline=None)
@given(TIMES, FLOAT32, st.lists(st.tuples(FLOAT32, FLOAT32), max_size=60), FLOAT32, FLOAT32)
def test_control_horizon(
    stamp: Time, step_ms: float, rows: list[tuple[float, float]], v: float, acc: float
) -> None:
    step_s = float(np.float32(step_ms)) / 1e3
    angles, rates = np.array(rows, np.float32).reshape(-1, 2).T
    message = {
        "stamp": stamp._asdict(),
        "control_time": ZERO,
        "time_step_ms": step_s * 1e3,
        "controls": [control(stamp, *row, (v, acc)) for row in rows],
    }
    data = debug.encode_control_horizon(stamp, step_s, angles, rates, v, acc)
    assert data == rosbags_bytes(debug.CONTROL_HORIZON, message)
    assert data == cyclone_bytes(debug.CONTROL_HORIZON, message)


@pytest.mark.parametrize("package", ["tier4_debug_msgs", "autoware_internal_debug_msgs"])
@settings(max_examples=60, deadline=None)
@given(TIMES, NUMBERS)
def test_float32_array_stamped(package: str, stamp: Time, values: list[float]) -> None:
    """Both names of the type have the same bytes."""
    data = debug.encode_float32_array_stamped(stamp, np.array(values, np.float32))
    message = {"stamp": stamp._asdict(), "data": values}
    assert data == rosbags_bytes(f"{package}/msg/Float32MultiArrayStamped", message)


VALUES = st.lists(st.tuples(TEXTS, TEXTS), max_size=3).map(tuple)
STATUSES = st.builds(Diagnostic, TEXTS, TEXTS, st.booleans(), VALUES, TEXTS)


@settings(max_examples=60, deadline=None)
@given(TIMES, st.lists(STATUSES, max_size=4))
def test_diagnostics(stamp: Time, statuses: list[Diagnostic]) -> None:
    found = [
        {
            "level": 2 if item.is_error else 0,
            "name": item.name,
            "message": item.message,
            "hardware_id": item.hardware_id,
            "values": [{"key": key, "value": value} for key, value in item.values],
        }
        for item in statuses
    ]
    message = {"header": {"stamp": stamp._asdict(), "frame_id": ""}, "status": found}
    data = debug.encode_diagnostics(stamp, statuses)
    assert data == rosbags_bytes(debug.DIAGNOSTIC_ARRAY, message)
