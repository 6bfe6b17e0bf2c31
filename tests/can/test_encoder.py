# SPDX-License-Identifier: Apache-2.0
"""The encoder, against values worked out by hand and against exact arithmetic."""

from __future__ import annotations

import math
import struct
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety_island.can.candump import format_frame
from safety_island.can.command import Cause, Command, as_published
from safety_island.can.decoder import Decoded, decode
from safety_island.can.encoder import Rejection, Triple, encode
from safety_island.command.frames import LATERAL, LONGITUDINAL
from safety_island.command.mode import OutputMode
from tests.can.rig import REFERENCE, REFERENCE_LINES, REFERENCE_STAMP_NS

INT32_MAX = 2**31 - 1
INT32_MIN = -(2**31)
SIGNALS = {signal.name: signal for frame in (LATERAL, LONGITUDINAL) for signal in frame.signals}
FRAME_OF = {s.name: f.arbitration_id for f in (LATERAL, LONGITUDINAL) for s in f.signals}
NAMES = sorted(SIGNALS)
MODE = OutputMode.DDS_AND_CAN
RAW = {
    "steering_tire_angle": lambda frames: struct.unpack("<ii", frames[0].data)[0],
    "steering_tire_rotation_rate": lambda frames: struct.unpack("<ii", frames[0].data)[1],
    "velocity": lambda frames: struct.unpack("<ii", frames[1].data)[0],
    "acceleration": lambda frames: struct.unpack("<ii", frames[1].data)[1],
}


def changed(command: Command, name: str, value: Any) -> Command:
    return command._replace(**{name: value})


def only(name: str, value: Any) -> Command:
    return changed(Command(), name, value)


def frames_of(command: Command, sequence: int = 0, stamp_ns: int = 0) -> Triple:
    frames = encode(command, MODE, sequence, stamp_ns)
    assert not isinstance(frames, Rejection), frames
    return frames


def raw_of(name: str, value: Any) -> int:
    return int(RAW[name](frames_of(only(name, value))))


def test_reference_vector() -> None:
    frames = frames_of(REFERENCE, 42, REFERENCE_STAMP_NS)
    assert tuple(map(format_frame, frames)) == REFERENCE_LINES
    assert struct.unpack("<ii", frames[0].data) == (125000, -500000)
    assert struct.unpack("<ii", frames[1].data) == (12250, -1500)
    assert struct.unpack("<BBHI", frames[2].data) == (2, 0x0B, 42, 12345)


@pytest.mark.parametrize("mode", OutputMode)
def test_the_status_frame_names_the_mode(mode: OutputMode) -> None:
    frames = encode(REFERENCE, mode, 42, REFERENCE_STAMP_NS)
    assert not isinstance(frames, Rejection)
    if mode is OutputMode.DDS_ONLY:
        assert frames == ()
    else:
        assert frames[2].data[0] == mode.value


@pytest.mark.parametrize(
    ("rate", "acceleration", "jerk", "flags"),
    [
        (False, False, False, 0x08),
        (True, False, False, 0x09),
        (False, True, False, 0x0A),
        (False, False, True, 0x0C),
        (True, True, True, 0x0F),
    ],
)
def test_flags(rate: bool, acceleration: bool, jerk: bool, flags: int) -> None:
    command = Command(
        is_defined_steering_tire_rotation_rate=rate,
        is_defined_acceleration=acceleration,
        is_defined_jerk=jerk,
    )
    assert frames_of(command)[2].data[1] == flags


def test_an_undefined_value_is_encoded_as_it_stands() -> None:
    assert raw_of("steering_tire_rotation_rate", 0.25) == 250000


@pytest.mark.parametrize(
    ("value", "raw"),
    [
        (0.0005, 1),
        (-0.0005, -1),
        (0.0015, 2),
        (-0.0025, -3),
        (0.5 / 1000 - 1e-12, 0),
        (1.0004, 1000),
        (-1.0006, -1001),
        (-0.0, 0),
        (2.5, 2500),
    ],
)
def test_rounding_is_half_away_from_zero(value: float, raw: int) -> None:
    assert raw_of("velocity", value) == raw


@given(st.sampled_from(NAMES), st.floats(width=32, min_value=-2000.0, max_value=2000.0))
def test_a_single_precision_value_is_rounded_exactly(name: str, value: float) -> None:
    scaled = Fraction(value) * SIGNALS[name].scale
    exact = math.floor(abs(scaled) + Fraction(1, 2)) * (1 if scaled >= 0 else -1)
    assert raw_of(name, value) == exact


@given(st.sampled_from(NAMES), st.integers(INT32_MIN, INT32_MAX))
def test_every_raw_value_survives_the_round_trip(name: str, raw: int) -> None:
    frames = frames_of(only(name, raw / SIGNALS[name].scale))
    assert RAW[name](frames) == raw
    decoded = decode(frames)
    assert isinstance(decoded, Decoded)
    value = getattr(decoded.command, name)
    assert value == raw / SIGNALS[name].scale
    assert frames_of(decoded.command) == frames


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("raw", "expected"),
    [
        (INT32_MAX, INT32_MAX),
        (INT32_MIN, INT32_MIN),
        (INT32_MAX + 0.25, INT32_MAX),
        (INT32_MIN - 0.25, INT32_MIN),
        (INT32_MAX + 0.75, None),
        (INT32_MIN - 0.75, None),
        (1e300, None),
        (-1e300, None),
        (1.7e308, None),
    ],
)
def test_limits_of_int32_after_rounding(name: str, raw: float, expected: int | None) -> None:
    value = raw / SIGNALS[name].scale if raw < 1e308 else raw
    found = encode(only(name, value), MODE, 0, 0)
    if expected is None:
        assert found == Rejection(FRAME_OF[name], name, value, Cause.OUT_OF_RANGE)
    else:
        assert raw_of(name, value) == expected


@pytest.mark.parametrize("raw", [INT32_MAX + 0.5, INT32_MIN - 0.5])
def test_a_half_beyond_the_limit_rounds_out_of_range(raw: float) -> None:
    value = raw / 1000
    expected = Rejection(0x101, "velocity", value, Cause.OUT_OF_RANGE)
    assert encode(only("velocity", value), MODE, 0, 0) == expected


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_value_that_is_not_finite_rejects_the_command(name: str, value: float) -> None:
    found = encode(changed(REFERENCE, name, value), MODE, 0, 0)
    assert isinstance(found, Rejection)
    assert (found.arbitration_id, found.signal) == (FRAME_OF[name], name)
    assert found.cause is Cause.NOT_FINITE
    assert found.describe() == f"{name} is {value}, expected a finite number"


def test_an_undefined_value_must_be_finite_as_well() -> None:
    command = Command(steering_tire_rotation_rate=math.nan)
    assert isinstance(encode(command, MODE, 0, 0), Rejection)


def test_jerk_must_be_finite_only_when_it_is_defined() -> None:
    found = encode(Command(jerk=math.nan, is_defined_jerk=True), MODE, 0, 0)
    assert isinstance(found, Rejection)
    assert (found.arbitration_id, found.signal, found.cause) == (0x102, "jerk", Cause.NOT_FINITE)
    assert frames_of(Command(jerk=math.nan))[2].data[1] == 0x08
    assert frames_of(Command(jerk=1e30, is_defined_jerk=True))[2].data[1] == 0x0C


def test_a_rejection_says_what_is_allowed() -> None:
    found = encode(Command(velocity=3e6), MODE, 0, 0)
    assert isinstance(found, Rejection)
    assert found.describe() == (
        "velocity is 3000000, expected -2147483.648 to 2147483.647 m/s (int32 after scaling)"
    )


@pytest.mark.parametrize(("sequence", "sent"), [(0, 0), (65535, 65535), (65536, 0), (65537, 1)])
def test_the_sequence_wraps(sequence: int, sent: int) -> None:
    assert struct.unpack("<H", frames_of(REFERENCE, sequence)[2].data[2:4]) == (sent,)


@pytest.mark.parametrize(
    ("stamp_ns", "sent"),
    [
        (0, 0),
        (999_999, 0),
        (1_000_000, 1),
        (12_345_999_999, 12345),
        ((2**32 - 1) * 1_000_000, 2**32 - 1),
        (2**32 * 1_000_000, 0),
        ((2**32 + 5) * 1_000_000, 5),
        (1_700_000_000_123_456_789, 1_700_000_000_123 % 2**32),
        (-1_000_000, 2**32 - 1),
    ],
)
def test_the_timestamp_is_whole_milliseconds_modulo_2_to_the_32(stamp_ns: int, sent: int) -> None:
    assert struct.unpack("<I", frames_of(REFERENCE, 0, stamp_ns)[2].data[4:]) == (sent,)


@given(st.sampled_from(NAMES), st.floats(min_value=-2000.0, max_value=2000.0))
def test_frames_agree_with_the_single_precision_of_the_message(name: str, value: float) -> None:
    published = float(np.float32(value))
    command = as_published(only(name, value))
    assert getattr(command, name) == published
    assert RAW[name](frames_of(command)) == raw_of(name, published)


def test_a_value_beyond_single_precision_stays_out_of_range() -> None:
    command = as_published(REFERENCE._replace(velocity=1e300))
    found = encode(command, MODE, 0, 0)
    assert isinstance(found, Rejection)
    assert found.cause is Cause.OUT_OF_RANGE


def test_numpy_scalars_are_scaled_in_double_precision() -> None:
    value = np.float32(0.123456)
    assert raw_of("steering_tire_angle", value) == raw_of("steering_tire_angle", float(value))


def test_a_value_of_single_precision_is_scaled_in_double() -> None:
    value = np.float32(123.456)  # 123.456001...; as a product in single precision 123456000
    assert raw_of("steering_tire_angle", value) == 123456001


def test_the_frames_are_a_tuple_of_plain_bytes_whatever_the_numbers_are_made_of() -> None:
    plain = Command(is_defined_acceleration=True, acceleration=1.5)
    frames = frames_of(changed(plain, "is_defined_acceleration", np.True_))
    assert frames == frames_of(plain) and type(frames) is tuple
