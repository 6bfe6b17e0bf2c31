# SPDX-License-Identifier: Apache-2.0
"""Which sample of several is looked at."""

from __future__ import annotations

import struct
from typing import NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety_island.input_gate.newest import (
    NO_STAMP,
    TRIES,
    in_order,
    newest_first,
    overtaken,
    read_stamp,
)


class Message(NamedTuple):
    data: bytes


def at(sec: int, nanosec: int = 0, tail: bytes = b"") -> Message:
    return Message(b"\0\1\0\0" + struct.pack("<iI", sec, nanosec) + tail)


BIG_ENDIAN = Message(b"\0\0\0\0" + struct.pack(">iI", 9, 9))
CUT = Message(at(9, 9).data[:-1])


def test_one_sample_is_looked_at_as_it_is() -> None:
    samples = [CUT]
    assert newest_first(samples) is samples and in_order(samples)[0] is samples


def test_the_highest_stamp_comes_first_whatever_the_order_of_arrival() -> None:
    assert newest_first([at(5, 1), at(5, 2), at(4, 9)]) == [at(5, 2), at(5, 1), at(4, 9)]


def test_of_equal_stamps_the_last_to_arrive() -> None:
    first, second = at(5, 1, b"first"), at(5, 1, b"second")
    assert newest_first([first, second]) == [second, first]


def test_what_has_no_stamp_comes_last() -> None:
    assert newest_first([at(0), BIG_ENDIAN]) == [at(0), BIG_ENDIAN]
    assert newest_first([at(0), CUT]) == [at(0), CUT]
    assert newest_first([CUT, Message(b"\1\0" + at(9).data[2:])])[1] == CUT
    assert newest_first([CUT, at(-2)]) == [at(-2), CUT]


def test_the_stamp_of_a_message() -> None:
    assert read_stamp(at(5, 7).data) == (5, 7)
    assert read_stamp(at(-5, 7).data) == (-5, 7)
    for message in (BIG_ENDIAN, CUT):
        assert read_stamp(message.data) == NO_STAMP


@pytest.mark.parametrize(
    "samples", [[at(5)], [at(1), at(2), at(3), at(4), at(4)], [at(1), at(3), at(2)], [CUT, at(1)]]
)
def test_both_at_once(samples: list[Message]) -> None:
    assert in_order(samples) == (newest_first(samples), overtaken(samples))


def test_no_more_than_three_are_tried() -> None:
    assert TRIES == 3
    assert newest_first([at(i) for i in range(9)]) == [at(8), at(7), at(6)]


def test_samples_that_were_overtaken() -> None:
    assert overtaken([at(1), at(2), at(3)]) == 0
    assert overtaken([at(2), at(2)]) == 0
    assert overtaken([at(3), at(2), at(1), at(4), at(3, 9)]) == 3
    assert overtaken([at(3, 5), at(3, 4)]) == 1
    assert overtaken([at(0), CUT]) == 1
    assert overtaken([CUT, BIG_ENDIAN]) == 0
    assert overtaken([at(-3), at(-2), at(-3)]) == 1


stamps = st.tuples(st.integers(-5, 5), st.integers(0, 5))


@given(st.lists(stamps, max_size=12))
def test_any_stream(times: list[tuple[int, int]]) -> None:
    samples = [at(*time, tail=bytes([i])) for i, time in enumerate(times)]
    found = newest_first(samples)
    assert in_order(samples) == (found, overtaken(samples))
    assert len(found) == min(len(samples), TRIES)
    assert len(set(found)) == len(found) and set(found) <= set(samples)
    if any(time >= (0, 0) for time in times):
        newest = max(range(len(times)), key=lambda i: (times[i], i))
        assert found[0] == samples[newest]


@given(st.lists(st.integers(0, 9), max_size=12))
def test_what_arrives_in_order_was_not_overtaken(times: list[int]) -> None:
    assert overtaken([at(time) for time in sorted(times)]) == 0
    lower = sum(time < max(times[:i], default=0) for i, time in enumerate(times))
    assert overtaken([at(time) for time in times]) == lower
