# SPDX-License-Identifier: Apache-2.0
"""The generic codec against two independent serializers, over random messages of every type."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from safety_island.kernel.cdr import DecodeReason
from safety_island.messages import codec, registry
from safety_island.messages.errors import DecodeError, EncodeError
from tests.messages.oracle import cyclone_bytes, rosbags_bytes
from tests.messages.strategies import messages

ODOMETRY = "nav_msgs/msg/Odometry"
NODE_INFO = "rmw_dds_common/msg/NodeEntitiesInfo"

any_type = pytest.mark.parametrize("name", registry.names())
random_messages = settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)


def same(a: Any, b: Any) -> bool:
    """Compare messages; NaN equals NaN."""
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, list | np.ndarray):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b, strict=True))
    return bool(a == b) or (a != a and b != b)


@any_type
@random_messages
@given(data=st.data())
def test_bytes_equal_those_of_independent_serializers(name: str, data: st.DataObject) -> None:
    message = data.draw(messages(name))
    ours = codec.encode(name, message)
    assert ours == rosbags_bytes(name, message)
    assert ours == cyclone_bytes(name, message)
    assert same(message, codec.decode(name, ours))


@any_type
@random_messages
@given(data=st.data())
def test_big_endian_decodes_to_the_same_message(name: str, data: st.DataObject) -> None:
    message = data.draw(messages(name))
    big = rosbags_bytes(name, message, little_endian=False)
    assert same(message, codec.decode(name, big))
    assert codec.to_little_endian(name, big) == codec.encode(name, message)


def test_missing_fields_take_their_defaults() -> None:
    message = codec.default(ODOMETRY)
    assert message["pose"]["pose"]["orientation"] == {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    assert message["child_frame_id"] == ""
    assert message["twist"]["covariance"].tolist() == [0.0] * 36


def test_padding_behind_a_message_is_accepted_and_more_is_not() -> None:
    name = "autoware_vehicle_msgs/msg/SteeringReport"
    data = codec.encode(name, {"steering_tire_angle": 0.25})
    assert codec.decode(name, data + bytes(3))["steering_tire_angle"] == 0.25
    with pytest.raises(DecodeError) as refused:
        codec.decode(name, data + bytes(4))
    assert refused.value.reason is DecodeReason.TRAILING


@pytest.mark.parametrize(
    "header", [b"\x00\x02", b"\x00\x03", b"\x00\x06", b"\x00\x07", b"\x00\x09", b"\x07\x01"]
)
def test_other_encapsulations_are_refused(header: bytes) -> None:
    data = header + codec.encode("builtin_interfaces/msg/Time", {})[2:]
    with pytest.raises(DecodeError, match=r"expected plain CDR \(XCDR1\)") as refused:
        codec.decode("builtin_interfaces/msg/Time", data)
    assert refused.value.reason is DecodeReason.ENCAPSULATION
    assert refused.value.type_name == "builtin_interfaces/msg/Time"


@pytest.mark.parametrize(
    ("name", "message", "said"),
    [
        (ODOMETRY, {"child": ""}, "has no field 'child'"),
        (ODOMETRY, {"child_frame_id": "a\0b"}, "must not contain NUL"),
        (ODOMETRY, {"header": {"stamp": {"sec": 2**31}}}, "nav_msgs/msg/Odometry"),
        (ODOMETRY, {"header": {"stamp": {"sec": "now"}}}, "nav_msgs/msg/Odometry"),
        (ODOMETRY, {"pose": {"covariance": [0.0] * 35}}, "35 elements, expected 36"),
        (NODE_INFO, {"node_name": "x" * 257}, "length 257 exceeds the bound 256"),
    ],
)
def test_a_value_that_does_not_fit_is_refused(name: str, message: Any, said: str) -> None:
    with pytest.raises(EncodeError, match=said):
        codec.encode(name, message)


def test_a_string_beyond_its_bound_is_refused() -> None:
    message = {"node_name": "x" * 256}
    data = bytearray(codec.encode(NODE_INFO, message))
    assert codec.decode(NODE_INFO, bytes(data))["node_name"] == "x" * 256
    place = data.index(b"xxxx") - 4
    data[place : place + 4] = (258).to_bytes(4, "little")
    with pytest.raises(DecodeError) as refused:
        codec.decode(NODE_INFO, bytes(data))
    assert refused.value.reason is DecodeReason.LENGTH


def test_a_boolean_of_two_is_refused() -> None:
    name = "autoware_adapi_v1_msgs/msg/OperationModeState"
    data = bytearray(codec.encode(name, {}))
    data[-1] = 2
    with pytest.raises(DecodeError) as refused:
        codec.decode(name, bytes(data))
    assert refused.value.reason is DecodeReason.BOOLEAN


def test_a_string_without_nul_or_not_utf8_is_refused() -> None:
    name = "std_msgs/msg/Header"
    good = codec.encode(name, {"frame_id": "map"})
    assert codec.decode(name, good[:-8] + bytes(4))["frame_id"] == ""
    for end in (b"mapx", b"m\0p\0", b"m\xffp\0"):
        with pytest.raises(DecodeError) as refused:
            codec.decode(name, good[:-4] + end)
        assert refused.value.reason is DecodeReason.STRING
