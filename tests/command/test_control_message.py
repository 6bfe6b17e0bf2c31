# SPDX-License-Identifier: Apache-2.0
"""The bytes of Control, against the generic codec."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety_island.command.control_message import write_control
from safety_island.command.encoding import Encoding
from safety_island.control.records import COMMAND
from safety_island.messages import codec
from safety_island.messages.fixed import FixedMessage
from safety_island.messages.outputs import CONTROL
from tests.messages.oracle import rosbags_bytes
from tests.messages.strategies import FLOAT32

NANOSECONDS = 10**9
MESSAGE, COMMAND_RECORD = FixedMessage(CONTROL), np.zeros(1, COMMAND)
STAMPS = st.floats(0.0, 1e6)
OFFSETS = st.integers(-(10**15), 2 * 10**18)


def written(values: Any, offset_ns: int = 0) -> int:
    """Fill the record and write the message; return what the kernel says."""
    COMMAND_RECORD[0] = values
    write_control.prepare()
    return write_control.call(COMMAND_RECORD, MESSAGE.body, offset_ns)


def stamp_of(nanoseconds: int) -> dict[str, int]:
    sec, nanosec = divmod(nanoseconds, NANOSECONDS)
    return {"sec": sec, "nanosec": nanosec}


@given(STAMPS, STAMPS, st.tuples(*[FLOAT32] * 4), st.booleans(), OFFSETS)
def test_a_command_is_the_message_that_other_serializers_write(
    stamp: float, other: float, numbers: Any, has_rate: bool, offset_ns: int
) -> None:
    assert written((stamp, other, *numbers, has_rate), offset_ns) == Encoding.DONE
    own = stamp_of(int(stamp * 1e9) + offset_ns)
    angle, rate, velocity, acceleration = numbers
    message = codec.default(CONTROL)
    message["stamp"] = own
    message["lateral"] |= {
        "stamp": own,
        "steering_tire_angle": angle,
        "steering_tire_rotation_rate": rate,
        "is_defined_steering_tire_rotation_rate": has_rate,
    }
    message["longitudinal"] |= {
        "stamp": stamp_of(int(other * 1e9) + offset_ns),
        "velocity": velocity,
        "acceleration": acceleration,
        "is_defined_acceleration": True,
    }
    data = MESSAGE.to_bytes()
    assert data == codec.encode(CONTROL, message)
    assert data == rosbags_bytes(CONTROL, message)


def test_a_message_has_nothing_of_the_one_before() -> None:
    body = MESSAGE.body[0]
    body.longitudinal.jerk, body.longitudinal.is_defined_jerk = 3.0, True
    assert written((1.0, 2.0, 0.1, 0.2, 0.3, 0.4, True)) == Encoding.DONE
    first = MESSAGE.to_bytes()
    assert written((9.0, 8.0, 0.7, 0.6, 0.5, 0.4, False), 55) == Encoding.DONE
    assert written((1.0, 2.0, 0.1, 0.2, 0.3, 0.4, True)) == Encoding.DONE
    assert MESSAGE.to_bytes() == first
    assert (body.longitudinal.jerk, body.longitudinal.is_defined_jerk) == (0.0, False)


FIRST_S, LAST_S = -(2**31), 2**31 - 1


@pytest.mark.parametrize("second", [FIRST_S, LAST_S])
@pytest.mark.parametrize("nanosec", [0, 999_999_999])
def test_the_first_and_the_last_second_fit(second: int, nanosec: int) -> None:
    assert written((0.0,) * 6 + (False,), second * NANOSECONDS + nanosec) == Encoding.DONE
    for stamp in (MESSAGE.body[0].stamp, MESSAGE.body[0].lateral.stamp):
        assert (stamp.sec, stamp.nanosec) == (second, nanosec)


@pytest.mark.parametrize("offset_ns", [FIRST_S * NANOSECONDS - 1, (LAST_S + 1) * NANOSECONDS])
def test_a_wall_clock_beyond_every_stamp_is_refused(offset_ns: int) -> None:
    assert written((0.0,) * 6 + (False,), offset_ns) == Encoding.OUT_OF_RANGE


@pytest.mark.parametrize("place", [0, 1])
@pytest.mark.parametrize("stamp", [math.nan, math.inf, -math.inf, 1e300, 2.0**32, -(2.0**32)])
def test_a_time_beyond_every_stamp_is_refused(place: int, stamp: float) -> None:
    stamps = [1.0, 1.0]
    stamps[place] = stamp
    offset_ns = -int(stamp * 1e9) if abs(stamp) <= 2.0**32 else 0  # the sum alone would fit
    assert written((*stamps, 0.0, 0.0, 0.0, 0.0, False), offset_ns) == Encoding.OUT_OF_RANGE


@pytest.mark.parametrize("stamp", [2.0**32 - 1.0, 1.0 - 2.0**32])
def test_a_time_that_fits_with_its_offset_is_written(stamp: float) -> None:
    offset_ns = 7 - int(stamp * 1e9)
    assert written((stamp, stamp, 0.0, 0.0, 0.0, 0.0, False), offset_ns) == Encoding.DONE
    assert (MESSAGE.body[0].stamp.sec, MESSAGE.body[0].stamp.nanosec) == (0, 7)
