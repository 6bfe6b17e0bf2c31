# SPDX-License-Identifier: Apache-2.0
"""Time stamps and alignment."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety_island.messages.wire import Time, aligned


@given(st.integers(-(2**31) * 10**9, 2**31 * 10**9 - 1))
def test_nanoseconds_return_exactly(nanoseconds: int) -> None:
    stamp = Time.from_nanoseconds(nanoseconds)
    assert stamp.nanoseconds == nanoseconds
    assert 0 <= stamp.nanosec < 10**9


@given(st.floats(-2e9, 2e9))
def test_seconds_return_within_their_own_resolution(seconds: float) -> None:
    stamp = Time.from_seconds(seconds)
    assert 0 <= stamp.nanosec < 10**9
    assert stamp.seconds == pytest.approx(seconds, abs=1e-9, rel=1e-15)


@pytest.mark.parametrize(
    ("seconds", "stamp"),
    [
        (12.345, Time(12, 345_000_000)),
        (0.0, Time(0, 0)),
        (-0.25, Time(-1, 750_000_000)),
        (0.9999999999, Time(1, 0)),
    ],
)
def test_stamps_of_known_times(seconds: float, stamp: Time) -> None:
    assert Time.from_seconds(seconds) == stamp


def test_alignment_counts_from_the_end_of_the_header() -> None:
    assert [aligned(offset, 8) for offset in (4, 5, 11, 12, 13)] == [4, 12, 12, 12, 20]
    assert [aligned(offset, 4) for offset in (4, 5, 8)] == [4, 8, 8]
