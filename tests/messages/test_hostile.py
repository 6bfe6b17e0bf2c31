# SPDX-License-Identifier: Apache-2.0
"""Bytes that want to do harm: cut, flipped, with absurd lengths. Rows 14, 15, 16, 19 of faults."""

from __future__ import annotations

import random
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.kernel.cdr import DecodeReason
from safety_island.messages import codec, registry
from safety_island.messages.errors import DecodeError
from safety_island.messages.inputs import ODOMETRY, decode_odometry
from safety_island.messages.trajectory import TRAJECTORY, decode_trajectory
from tests.messages.oracle import rosbags_bytes
from tests.messages.samples import Hot, hot_messages, trajectory_bytes

REFUSED = "refused"
LENGTHS = (0, 1, 2, 3, 4, 255, 2**16, 2**28, 2**31 - 1, 2**31, 2**32 - 8, 2**32 - 1)

each_hot = pytest.mark.parametrize("hot", hot_messages(), ids=lambda hot: hot.name)


@pytest.fixture
def big_endian_odometry() -> bytes:
    message = codec.default(ODOMETRY)
    message["child_frame_id"] = "base_link"
    return rosbags_bytes(ODOMETRY, message, little_endian=False)


def outcome(decode: Callable[[bytes], Any], data: bytes) -> Any:
    """Return the value, or what stands for an orderly refusal."""
    try:
        return decode(data)
    except DecodeError as problem:
        assert isinstance(problem.reason, DecodeReason)
        assert "\n" not in str(problem)
        return REFUSED


def refused(decode: Callable[[bytes], Any], data: bytes) -> bool:
    return isinstance(outcome(decode, data), str)


@each_hot
def test_every_truncation_is_refused(hot: Hot) -> None:
    for k in range(len(hot.data)):
        assert refused(hot.decode, hot.data[:k]), k
        assert refused(lambda data: codec.decode(hot.name, data), hot.data[:k]), k


@pytest.mark.parametrize("name", registry.names())
def test_every_truncation_of_every_type_is_refused(name: str) -> None:
    data = codec.encode(name, {})
    for k in range(len(data)):
        assert refused(lambda cut: codec.decode(name, cut), data[:k])


@each_hot
def test_every_bit_flip_is_refused_or_read_as_the_generic_codec_reads_it(hot: Hot) -> None:
    for bit in range(len(hot.data) * 8):
        data = bytearray(hot.data)
        data[bit // 8] ^= 1 << bit % 8
        generic = refused(lambda d: codec.decode(hot.name, d), bytes(data))
        assert refused(hot.decode, bytes(data)) == generic, bit


def test_every_bit_flip_of_a_trajectory_of_100_points() -> None:
    data = bytearray(trajectory_bytes(100))
    sizes = set()
    for bit in range(len(data) * 8):
        data[bit // 8] ^= 1 << bit % 8
        found = outcome(decode_trajectory, bytes(data))
        sizes.add(0 if found == REFUSED else len(found.points))
        data[bit // 8] ^= 1 << bit % 8
    assert sizes == {0, 100}


def test_a_big_endian_message_is_damaged_as_safely(big_endian_odometry: bytes) -> None:
    for bit in range(len(big_endian_odometry) * 8):
        data = bytearray(big_endian_odometry)
        data[bit // 8] ^= 1 << bit % 8
        outcome(decode_odometry, bytes(data))


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("place", [12, 20])
def test_absurd_lengths_allocate_nothing(length: int, place: int) -> None:
    """Place 12 holds the length of frame_id, place 20 the number of points."""
    data = bytearray(trajectory_bytes(3))
    assert data[12:16] == b"\4\0\0\0" and data[20:24] == b"\3\0\0\0"
    data[place : place + 4] = length.to_bytes(4, "little")
    attacked = bytes(data)
    decode_trajectory(trajectory_bytes(1))  # the memory of the decoders is made once
    for decode in (decode_trajectory, lambda d: codec.decode(TRAJECTORY, d)):
        tracemalloc.start()
        found = outcome(decode, attacked)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 100_000
        assert isinstance(found, str) == (bytes(data) != trajectory_bytes(3))


@pytest.mark.parametrize("header", [b"\0\2", b"\0\3", b"\0\6", b"\0\7", b"\0\x0b", b"\xff\xff"])
@each_hot
def test_other_encapsulations_are_refused(hot: Hot, header: bytes) -> None:
    with pytest.raises(DecodeError) as problem:
        hot.decode(header + hot.data[2:])
    assert problem.value.reason is DecodeReason.ENCAPSULATION


@each_hot
def test_options_of_the_header_and_padding_do_not_matter(hot: Hot) -> None:
    plain, odd = hot.decode(hot.data), hot.decode(hot.data[:2] + b"\xab\xcd" + hot.data[4:] + b"12")
    for a, b in zip(plain, odd, strict=True):
        assert np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b


@each_hot
@settings(max_examples=300, deadline=None)
@given(junk=st.binary(max_size=200))
def test_junk_is_refused_or_read(hot: Hot, junk: bytes) -> None:
    outcome(hot.decode, junk)
    outcome(hot.decode, b"\0\1\0\0" + junk)
    outcome(hot.decode, b"\0\0\0\0" + junk)
    outcome(lambda data: codec.decode(hot.name, data), b"\0\0\0\0" + junk)


@each_hot
def test_random_damage_ends_in_order(hot: Hot) -> None:
    seeded = random.Random(7)
    for _ in range(2000):
        data = bytearray(hot.data)
        for _ in range(seeded.randrange(1, 8)):
            data[seeded.randrange(len(data))] = seeded.randrange(256)
        outcome(hot.decode, bytes(data[: seeded.randrange(len(data) + 1)]))
