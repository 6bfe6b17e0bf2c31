# SPDX-License-Identifier: Apache-2.0
"""The decoder: what it reads, and what it refuses."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety_island.can.command import Command
from safety_island.can.decoder import Decoded, Fault, decode, decode_frame
from safety_island.can.encoder import Rejection, encode
from safety_island.command.frames import LATERAL, STATUS
from safety_island.command.mode import OutputMode
from safety_island.platform.interfaces import CanFrame
from tests.can.rig import REFERENCE, triple


def test_reference_vector() -> None:
    assert decode(triple()) == Decoded(REFERENCE, OutputMode.DDS_AND_CAN, 42, 12345)


def test_a_frame_by_itself() -> None:
    assert decode_frame(LATERAL, bytes.fromhex("48E80100E05EF8FF")) == {
        "steering_tire_angle": 0.125,
        "steering_tire_rotation_rate": -0.5,
    }
    with pytest.raises(ValueError, match="COMMAND_STATUS has 7 bytes, expected 8"):
        decode_frame(STATUS, bytes(7))


@given(
    st.lists(st.integers(-(2**31), 2**31 - 1), min_size=4, max_size=4),
    st.tuples(st.booleans(), st.booleans(), st.booleans()),
    st.sampled_from([OutputMode.CAN_ONLY, OutputMode.DDS_AND_CAN]),
    st.integers(0, 65535),
    st.integers(0, 2**32 - 1),
)
def test_what_was_encoded_is_decoded(
    raw: list[int],
    flags: tuple[bool, bool, bool],
    mode: OutputMode,
    sequence: int,
    timestamp_ms: int,
) -> None:
    values = (raw[0] / 1e6, raw[1] / 1e6, raw[2] / 1e3, raw[3] / 1e3, 0.0)
    command = Command(*values, *flags)
    frames = encode(command, mode, sequence, timestamp_ms * 1_000_000)
    assert not isinstance(frames, Rejection)
    assert decode(frames) == Decoded(command, mode, sequence, timestamp_ms)


def changed(index: int, data: bytes) -> list[CanFrame]:
    frames = list(triple())
    frames[index] = frames[index]._replace(data=data)
    return frames


@pytest.mark.parametrize(
    ("frames", "fault"),
    [
        ([], Fault.WRONG_FRAMES),
        (triple()[:2], Fault.WRONG_FRAMES),
        (triple()[::-1], Fault.WRONG_FRAMES),
        ((*triple(), *triple()), Fault.WRONG_FRAMES),
        (changed(0, bytes(7)), Fault.WRONG_LENGTH),
        (changed(2, b""), Fault.WRONG_LENGTH),
        (changed(2, bytes.fromhex("02032A0039300000")), Fault.NOT_VALID),
        (changed(2, bytes.fromhex("021B2A0039300000")), Fault.RESERVED_BITS),
        (changed(2, bytes.fromhex("000B2A0039300000")), Fault.WRONG_MODE),
        (changed(2, bytes.fromhex("030B2A0039300000")), Fault.WRONG_MODE),
    ],
)
def test_what_no_encoder_made_is_refused(frames: list[CanFrame], fault: Fault) -> None:
    assert decode(frames) is fault


@given(st.lists(st.binary(min_size=8, max_size=8), min_size=3, max_size=3))
def test_any_bytes_decode_or_are_refused(data: list[bytes]) -> None:
    frames = [CanFrame(0x100 + index, content) for index, content in enumerate(data)]
    found = decode(frames)
    if isinstance(found, Decoded):
        again = encode(found.command, found.mode, found.sequence, found.timestamp_ms * 1_000_000)
        assert list(again) == frames
