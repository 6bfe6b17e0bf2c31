# SPDX-License-Identifier: Apache-2.0
"""The hot codecs of the inputs against the generic one and against independent serializers."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.messages import codec, inputs
from safety_island.messages.errors import DecodeError
from safety_island.messages.wire import Time
from tests.messages.oracle import rosbags_bytes
from tests.messages.strategies import FLOAT32, FLOAT64, TEXTS, TIMES

COVARIANCES = st.tuples(*[FLOAT64] * 36)
many = settings(max_examples=150, deadline=None)


def equal(a: Any, b: Any) -> bool:
    """Compare flat tuples; NaN equals NaN."""
    return len(a) == len(b) and all(
        x == y or (x != x and y != y) for x, y in zip(a, b, strict=True)
    )


def vector(x: float, y: float, z: float) -> dict[str, float]:
    return {"x": x, "y": y, "z": z}


@many
@given(TIMES, TEXTS, TEXTS, st.tuples(*[FLOAT64] * 13), COVARIANCES, COVARIANCES)
def test_odometry(
    stamp: Time, frame: str, child: str, n: tuple[float, ...], pose: Any, twist: Any
) -> None:
    data = inputs.encode_odometry(inputs.Odometry(stamp, frame, child, *n), pose, twist)
    orientation = {"x": n[3], "y": n[4], "z": n[5], "w": n[6]}
    message = {
        "header": {"stamp": stamp._asdict(), "frame_id": frame},
        "child_frame_id": child,
        "pose": {
            "pose": {"position": vector(*n[:3]), "orientation": orientation},
            "covariance": list(pose),
        },
        "twist": {
            "twist": {"linear": vector(*n[7:10]), "angular": vector(*n[10:])},
            "covariance": list(twist),
        },
    }
    assert data == rosbags_bytes(inputs.ODOMETRY, message)
    assert equal(inputs.decode_odometry(data), (stamp, frame, child, *n))


def test_a_damaged_message_leaves_no_layout_behind() -> None:
    """The layout of the message before is remembered: of the last whole one."""
    ours, other = (
        inputs.encode_odometry(inputs.Odometry(Time(1, 2), frame, "base", *map(float, range(13))))
        for frame in ("map", "odom")
    )
    for data, frame in [(ours, "map"), (other[:-8], None), (ours, "map"), (other, "odom")]:
        if frame is None:
            with pytest.raises(DecodeError):
                inputs.decode_odometry(data)
        else:
            assert inputs.decode_odometry(data)[:3] == (Time(1, 2), frame, "base")


@many
@given(TIMES, TEXTS, st.tuples(*[FLOAT64] * 6), COVARIANCES)
def test_acceleration(stamp: Time, frame: str, n: tuple[float, ...], covariance: Any) -> None:
    data = inputs.encode_acceleration(inputs.Acceleration(stamp, frame, *n), covariance)
    accel = {"linear": vector(*n[:3]), "angular": vector(*n[3:])}
    message = {
        "header": {"stamp": stamp._asdict(), "frame_id": frame},
        "accel": {"accel": accel, "covariance": list(covariance)},
    }
    assert data == rosbags_bytes(inputs.ACCELERATION, message)
    assert equal(inputs.decode_acceleration(data), (stamp, frame, *n))


@many
@given(TIMES, FLOAT32)
def test_steering(stamp: Time, angle: float) -> None:
    data = inputs.encode_steering(inputs.Steering(stamp, angle))
    message = {"stamp": stamp._asdict(), "steering_tire_angle": angle}
    assert data == rosbags_bytes(inputs.STEERING, message)
    assert equal(inputs.decode_steering(data), (stamp, angle))


@many
@given(TIMES, st.integers(0, 255), st.tuples(*[st.booleans()] * 6))
def test_operation_mode(stamp: Time, mode: int, flags: Any) -> None:
    state = inputs.OperationMode(stamp, mode, *flags)
    data = inputs.encode_operation_mode(state)
    message = {**state._asdict(), "stamp": stamp._asdict()}
    assert data == rosbags_bytes(inputs.OPERATION_MODE, message)
    assert inputs.decode_operation_mode(data) == state


def test_covariances_default_to_zero() -> None:
    data = inputs.encode_acceleration(inputs.Acceleration(Time(), "", *[1.0] * 6))
    assert not codec.decode(inputs.ACCELERATION, data)["accel"]["covariance"].any()


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_values_are_not_judged_here(bad: float) -> None:
    data = inputs.encode_steering(inputs.Steering(Time(-1, 2**32 - 1), bad))
    found = inputs.decode_steering(data)
    assert found.stamp == (-1, 2**32 - 1)
    assert equal((found.steering_tire_angle,), (bad,))
