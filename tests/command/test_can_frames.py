# SPDX-License-Identifier: Apache-2.0
"""The kernel of the frames, against exact arithmetic over the table; values by hand: tests/can."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from safety_island.command.can_frames import CAN_COMMAND, CAN_FRAMES, encode_frames
from safety_island.command.encoding import Encoding
from safety_island.command.frames import FRAMES
from safety_island.command.mode import OutputMode
from tests.messages.strategies import FLOAT64

RECORD, TRIPLE = np.zeros(1, CAN_COMMAND), np.zeros(1, CAN_FRAMES)
VALUES = CAN_COMMAND.names[:4]
FINITE = st.floats(-3000.0, 3000.0) | st.floats(width=32, min_value=-40.0, max_value=40.0)
COMMANDS = st.tuples(*[FINITE | FLOAT64] * 4, FLOAT64, *[st.booleans()] * 3)


def encoded(command: Any, mode: int, sequence: int, stamp_ns: int) -> int:
    RECORD[0] = command
    encode_frames.prepare()
    return encode_frames.call(RECORD, TRIPLE, mode, sequence, stamp_ns)


def raw_of(value: float, scale: int) -> int:
    """Value x scale as double precision has it, then rounded half away from zero, exactly."""
    scaled = Fraction(value * scale)
    return math.floor(abs(scaled) + Fraction(1, 2)) * (1 if scaled >= 0 else -1)


def rejection(command: Any) -> tuple[int, int] | None:
    """The first value that has no encoding, and why; the jerk comes first."""
    if command[7] and not math.isfinite(command[4]):
        return Encoding.NOT_FINITE, 4
    scales = [signal.scale for frame in FRAMES[:2] for signal in frame.signals]
    for field, scale in enumerate(scales):
        value = command[field]
        if not math.isfinite(value):
            return Encoding.NOT_FINITE, field
        if math.isinf(value * scale) or not -(2**31) <= raw_of(value, scale) < 2**31:
            return Encoding.OUT_OF_RANGE, field
    return None


@given(COMMANDS, st.integers(0, 2), st.integers(0, 2**40), st.integers(-(2**63), 2**63 - 1))
@example((2147.4836475, 0.0, 0.0, 0.0, 0.0, True, True, True), 1, 65535, -1)
@example((0.0, -2147.4836485, 0.0, 0.0, math.nan, True, False, False), 1, 65536, 999_999)
@example((0.0, 0.0, 2147483.6475, 0.0, 0.0, False, True, False), 2, 1, 1_000_000)
def test_the_frames_hold_what_the_table_says(
    command: Any, mode: int, sequence: int, stamp_ns: int
) -> None:
    result, why = encoded(command, mode, sequence, stamp_ns), rejection(command)
    if mode == OutputMode.DDS_ONLY:
        assert (result, TRIPLE[0].rejected) == (Encoding.NOT_USED, -1)
        return
    if why is not None:
        assert (result, TRIPLE[0].rejected) == why
        return
    assert (result, TRIPLE[0].rejected) == (Encoding.DONE, -1)
    told = dict(zip(VALUES, command, strict=False)) | {
        "mode": mode,
        "steering_rate_defined": command[5],
        "acceleration_defined": command[6],
        "jerk_defined": command[7],
        "frame_valid": 1,
        "sequence": sequence,
        "timestamp": stamp_ns // 1_000_000,
    }
    for frame, found in zip(FRAMES, TRIPLE[0].frame, strict=True):
        assert found["arbitration_id"] == frame.arbitration_id
        word = 0
        for signal in frame.signals:
            raw = raw_of(told[signal.name], signal.scale)
            word |= (raw % 2**signal.bits) << signal.start_bit
        assert found["payload"].tobytes() == word.to_bytes(8, "little")


@pytest.mark.parametrize("mode", OutputMode)
def test_no_bit_of_an_earlier_command_is_left(mode: OutputMode) -> None:
    assert encoded((-1e-6, -1e-6, -1e-3, -1e-3, 0.0, True, True, True), 2, 65535, -1) == 0
    encoded((math.nan, 0.0, 0.0, 0.0, 0.0, False, False, False), mode, 0, 0)
    assert not TRIPLE[0].frame["payload"].any()
    assert encoded((0.0,) * 5 + (False,) * 3, OutputMode.CAN_ONLY, 0, 0) == Encoding.DONE
    assert TRIPLE[0].frame["payload"].tobytes() == bytes(16) + b"\x01\x08" + bytes(6)
