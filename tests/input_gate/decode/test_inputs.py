# SPDX-License-Identifier: Apache-2.0
"""The kernels that decode the inputs, against the generic codec, which shares nothing with them."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Mapping
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.input_gate.decode.records import MAX_SAMPLE, START
from safety_island.input_gate.reason import GOOD, SampleReason
from safety_island.kernel.cdr import HEADER_SIZE, DecodeReason
from safety_island.messages import codec
from safety_island.messages.errors import DecodeError
from safety_island.messages.inputs import ODOMETRY, OPERATION_MODE
from safety_island.messages.trajectory import TRAJECTORY
from tests.input_gate.decode.damage import KERNELS, POINTS, SAMPLE, damaged, decode, whole
from tests.messages.oracle import rosbags_bytes
from tests.messages.samples import trajectory_bytes
from tests.messages.strategies import messages

BIG = st.booleans()

each_kind = pytest.mark.parametrize("name", KERNELS)


def flat(message: Mapping[str, Any]) -> list[Any]:
    """Return all values of a message in the order of the wire, but for covariances."""
    found: list[Any] = []
    for key, value in message.items():
        if isinstance(value, Mapping):
            found += flat(value)
        elif key == "points":
            found += [number for point in value for number in flat(point)]
        elif key != "covariance":
            found.append(value)
    return found


def decoded(name: str) -> list[Any]:
    """Return the same of what the kernels have filled in last."""
    record = KERNELS[name][1]
    texts = {"frame_at": "frame_size", "child_at": "child_size"}
    found: list[Any] = []
    for field, value in zip(record.dtype.names or (), record[0].item(), strict=True):
        if field in texts:
            size = record[0][texts[field]]
            found.append(SAMPLE[0].bytes[value : value + size].tobytes().decode())
        elif field not in texts.values():
            found.append(value)
    return found[:3] + trajectory_values(found) if name == TRAJECTORY else found


def trajectory_values(found: list[Any]) -> list[Any]:
    n, _, *time = found[3:]
    values: list[Any] = []
    for row in POINTS[:n]:
        *numbers, sec, nanosec = row.item()
        values += [*time, *numbers]
        time = [sec, nanosec]
    assert time == [0, 0]
    return values


def same(a: list[Any], b: list[Any]) -> bool:
    return len(a) == len(b) and all(
        x == y or (x != x and y != y) for x, y in zip(a, b, strict=True)
    )


def agree(name: str, data: bytes) -> bool:
    """Whether the kernels and the generic codec accept the same, with the same values."""
    reason = decode(name, data)
    try:
        message = codec.decode(name, data)
    except DecodeError:
        return reason in list(DecodeReason)
    return reason == GOOD and same(decoded(name), flat(message))


@each_kind
@settings(max_examples=60)
@given(data=st.data(), is_big=BIG)
def test_every_message_is_read_as_it_was_written(name: str, data: Any, is_big: bool) -> None:
    message = data.draw(messages(name))
    assert agree(name, rosbags_bytes(name, message, little_endian=not is_big))


@each_kind
@settings(max_examples=60)
@given(data=st.data(), is_big=BIG)
def test_damage_is_accepted_and_refused_as_by_the_generic_codec(
    name: str, data: Any, is_big: bool
) -> None:
    bad = bytearray(rosbags_bytes(name, data.draw(messages(name)), little_endian=not is_big))
    for _ in range(data.draw(st.integers(1, 3))):
        bad[data.draw(st.integers(0, len(bad) - 1))] ^= data.draw(st.integers(1, 255))
    end = data.draw(st.integers(0, len(bad)) | st.just(len(bad)))
    assert agree(name, bytes(bad[:end]))


def test_samples_with_damage_in_front() -> None:
    assert all(agree(name, data) for name, data in damaged(7, 600))


@pytest.mark.parametrize(("name", "data"), whole())
def test_every_truncation(name: str, data: bytes) -> None:
    assert decode(name, data) == GOOD
    for end in range(len(data)):
        assert decode(name, data[:end]) == DecodeReason.TRUNCATED


@pytest.mark.parametrize(("name", "data"), whole())
def test_padding_and_what_is_more_than_that(name: str, data: bytes) -> None:
    padding = -len(data) % 4
    assert decode(name, data + bytes(padding)) == GOOD
    assert decode(name, data + bytes(4)) == DecodeReason.TRAILING
    assert SAMPLE[0].found == 4


@each_kind
def test_a_sample_that_has_no_room_is_refused_by_its_size(name: str) -> None:
    assert decode(name, b"\0\1\0\0" + bytes(MAX_SAMPLE)) == DecodeReason.LENGTH
    assert SAMPLE[0].found == MAX_SAMPLE + 4
    assert decode(name, b"\0\7\0\0" + bytes(MAX_SAMPLE)) == DecodeReason.ENCAPSULATION


def test_the_largest_sample_has_room() -> None:
    data = bytearray(MAX_SAMPLE)
    data[:16] = b"\0\1\0\0" + bytes(8) + (MAX_SAMPLE - 20).to_bytes(4, "little")
    data[16:-5] = b"x" * (MAX_SAMPLE - 21)
    assert decode(TRAJECTORY, bytes(data)) == GOOD
    assert KERNELS[TRAJECTORY][1][0].frame_size == MAX_SAMPLE - 21


def test_more_points_than_there_is_room_for() -> None:
    data = bytearray(trajectory_bytes(len(POINTS)))
    assert decode(TRAJECTORY, bytes(data)) == GOOD
    before = POINTS.tobytes()
    assert decode(TRAJECTORY, trajectory_bytes(len(POINTS) + 1)) == DecodeReason.LENGTH
    assert SAMPLE[0].found == len(POINTS) + 1 and POINTS.tobytes() == before


@pytest.mark.parametrize("count", [2**28, 2**31 - 1, 2**31, 2**32 - 1])
def test_absurd_numbers_of_points(count: int) -> None:
    data = bytearray(trajectory_bytes(3))
    data[20:24] = count.to_bytes(4, "little")
    assert decode(TRAJECTORY, bytes(data)) == DecodeReason.TRUNCATED
    assert SAMPLE[0].found == 36 + count * 88 - 8


def test_a_flag_is_zero_or_one() -> None:
    (data,) = (data for name, data in whole()[:5] if name == OPERATION_MODE)
    for place in range(13, 19):
        bad = bytearray(data)
        bad[place] = 2
        assert decode(OPERATION_MODE, bytes(bad)) == DecodeReason.BOOLEAN
        assert SAMPLE[0].found == 2


def test_numbers_are_not_judged() -> None:
    message = codec.default(ODOMETRY)
    message["pose"]["pose"]["position"]["x"] = math.nan
    assert decode(ODOMETRY, codec.encode(ODOMETRY, message)) == GOOD


def test_the_reasons_are_those_of_a_sample() -> None:
    assert all(int(SampleReason[reason.name]) == reason for reason in DecodeReason)
    assert GOOD not in list(SampleReason)


def test_the_body_stands_where_numbers_are_aligned() -> None:
    place = SAMPLE[0].bytes.ctypes.data + START + HEADER_SIZE
    assert place % 8 == 0


def test_plain_python_gives_the_same_bytes() -> None:
    found = {
        subprocess.run(
            [sys.executable, "-m", "tests.input_gate.decode.damage"],
            env=os.environ | {"SAFETY_ISLAND_JIT": jit},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        for jit in ("0", "1")
    }
    assert len(found) == 1 and len(found.pop()) == 65
