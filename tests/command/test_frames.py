# SPDX-License-Identifier: Apache-2.0
"""The table of frames is what the contract says, and sound in itself."""

from __future__ import annotations

import pytest

from safety_island.can.targets import TARGET_OUTPUT, TargetOutput
from safety_island.command.frames import COMMAND_IDS, FRAME_BYTES, FRAMES, Frame, limits_text
from safety_island.command.mode import OutputMode

CONTRACT = {
    # signal: identifier, first bit, bits, signed, scale, unit; written down from the contract
    "steering_tire_angle": (0x100, 0, 32, True, 1_000_000, "rad"),
    "steering_tire_rotation_rate": (0x100, 32, 32, True, 1_000_000, "rad/s"),
    "velocity": (0x101, 0, 32, True, 1_000, "m/s"),
    "acceleration": (0x101, 32, 32, True, 1_000, "m/s^2"),
    "mode": (0x102, 0, 8, False, 1, ""),
    "steering_rate_defined": (0x102, 8, 1, False, 1, ""),
    "acceleration_defined": (0x102, 9, 1, False, 1, ""),
    "jerk_defined": (0x102, 10, 1, False, 1, ""),
    "frame_valid": (0x102, 11, 1, False, 1, ""),
    "sequence": (0x102, 16, 16, False, 1, ""),
    "timestamp": (0x102, 32, 32, False, 1, "ms"),
}


def test_the_table_is_the_contract() -> None:
    found = {
        s.name: (frame.arbitration_id, s.start_bit, s.bits, s.signed, s.scale, s.unit)
        for frame in FRAMES
        for s in frame.signals
    }
    assert found == CONTRACT
    assert {0x100, 0x101, 0x102} == COMMAND_IDS
    assert FRAME_BYTES == 8


@pytest.mark.parametrize("frame", FRAMES, ids=lambda frame: frame.name)
def test_signals_do_not_overlap_and_fit(frame: Frame) -> None:
    used = 0
    for signal in frame.signals:
        bits = signal.mask << signal.start_bit
        assert used & bits == 0, f"{signal.name} overlaps"
        used |= bits
    assert used < 1 << (8 * FRAME_BYTES)


def test_raw_limits_and_their_text() -> None:
    angle = FRAMES[0].signals[0]
    assert (angle.lowest, angle.highest) == (-(2**31), 2**31 - 1)
    sequence = next(s for s in FRAMES[2].signals if s.name == "sequence")
    assert (sequence.lowest, sequence.highest) == (0, 65535)
    assert limits_text("steering_tire_angle") == "-2147.483648 to 2147.483647 rad"
    assert limits_text("sequence") == "0 to 65535"


def test_modes_are_those_of_the_contract() -> None:
    assert {mode.name: mode.value for mode in OutputMode} == {
        "DDS_ONLY": 0,
        "CAN_ONLY": 1,
        "DDS_AND_CAN": 2,
    }
    assert [mode.uses_dds for mode in OutputMode] == [True, False, True]
    assert [mode.uses_can for mode in OutputMode] == [False, True, True]


def test_targets_start_as_the_contract_says() -> None:
    assert {
        "fvp_baser_aemv8r_smp": TargetOutput(OutputMode.DDS_ONLY, None),
        "s32z270dc2_rtu0_r52@D": TargetOutput(OutputMode.DDS_AND_CAN, "socketcan:can0"),
        "freertos_posix": TargetOutput(OutputMode.DDS_AND_CAN, "mock"),
        "posix": TargetOutput(OutputMode.DDS_ONLY, None),
    } == TARGET_OUTPUT
