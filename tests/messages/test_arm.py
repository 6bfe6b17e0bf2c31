# SPDX-License-Identifier: Apache-2.0
"""The request to arm against independent bytes."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from safety_island.messages.arm import ARM, Arm, decode_arm, encode_arm
from safety_island.messages.wire import Time
from tests.messages.oracle import rosbags_bytes
from tests.messages.strategies import TIMES


@given(TIMES, st.integers(0, 2**64 - 1))
def test_arm(stamp: Time, nonce: int) -> None:
    request = Arm(stamp, nonce)
    data = encode_arm(request)
    message = {"stamp": stamp._asdict(), "nonce": nonce}
    assert data == rosbags_bytes(ARM, message)
    assert decode_arm(data) == request
    assert decode_arm(rosbags_bytes(ARM, message, little_endian=False)) == request
