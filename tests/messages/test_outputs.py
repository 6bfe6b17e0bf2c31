# SPDX-License-Identifier: Apache-2.0
"""The hot codecs of the outputs against independent bytes."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.messages import outputs
from safety_island.messages.outputs import Control
from safety_island.messages.wire import Time
from tests.messages.oracle import rosbags_bytes
from tests.messages.strategies import FLOAT32, FLOAT64, TIMES

ZERO = {"sec": 0, "nanosec": 0}
FLAGS = st.tuples(*[st.booleans()] * 3)


LATERAL = (
    "steering_tire_angle",
    "steering_tire_rotation_rate",
    "is_defined_steering_tire_rotation_rate",
)
LONGITUDINAL = ("velocity", "acceleration", "jerk", "is_defined_acceleration", "is_defined_jerk")


def message_of(command: Control) -> dict[str, Any]:
    lateral_stamp = (command.lateral_stamp or command.stamp)._asdict()
    lateral = {name: getattr(command, name) for name in LATERAL}
    longitudinal = {name: getattr(command, name) for name in LONGITUDINAL}
    inner = command.longitudinal_stamp._asdict()
    return {
        "stamp": command.stamp._asdict(),
        "control_time": ZERO,
        "lateral": {"stamp": lateral_stamp, "control_time": ZERO, **lateral},
        "longitudinal": {"stamp": inner, "control_time": ZERO, **longitudinal},
    }


@settings(max_examples=200, deadline=None)
@given(TIMES, TIMES, st.none() | TIMES, st.tuples(*[FLOAT32] * 5), FLAGS)
def test_control(stamp: Time, inner: Time, lateral: Time | None, n: Any, flags: Any) -> None:
    command = Control(stamp, inner, *n, *flags)._replace(lateral_stamp=lateral)
    data = outputs.encode_control(command)
    assert data == rosbags_bytes(outputs.CONTROL, message_of(command))
    found = outputs.decode_control(data)
    assert outputs.encode_control(found) == data
    assert found.lateral_stamp == (lateral or stamp)
    assert (found.stamp, found.longitudinal_stamp) == (stamp, inner)


@settings(max_examples=100, deadline=None)
@given(TIMES, FLOAT64)
def test_float64_stamped(stamp: Time, value: float) -> None:
    data = outputs.encode_float64_stamped(stamp, value)
    message = {"stamp": stamp._asdict(), "data": value}
    assert data == rosbags_bytes(outputs.FLOAT64_STAMPED, message)
    found_stamp, found = outputs.decode_float64_stamped(data)
    assert found_stamp == stamp
    assert found == value or (found != found and value != value)


def test_numpy_scalars_are_as_good_as_python_numbers() -> None:
    values = (0.5, 0.25, 1.5, -0.5)
    a = Control(Time(1, 2), Time(3, 4), *values)
    b = Control(Time(1, 2), Time(3, 4), *np.array(values, np.float32))
    assert outputs.encode_control(a) == outputs.encode_control(b)
