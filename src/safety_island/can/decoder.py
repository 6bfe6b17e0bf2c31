# SPDX-License-Identifier: Apache-2.0
"""Decoder of the three frames: pure functions that follow the table of ``frames``."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from typing import NamedTuple

from safety_island.can.command import Command
from safety_island.command.frames import FRAME_BYTES, FRAMES, STATUS, Frame
from safety_island.command.mode import OutputMode
from safety_island.platform.interfaces import CanFrame


class Fault(StrEnum):
    """Why three frames are not a command."""

    WRONG_FRAMES = "wrong_frames"
    WRONG_LENGTH = "wrong_length"
    NOT_VALID = "not_valid"
    RESERVED_BITS = "reserved_bits"
    WRONG_MODE = "wrong_mode"


class Decoded(NamedTuple):
    """What three frames say."""

    command: Command
    mode: OutputMode
    sequence: int
    timestamp_ms: int


def decode_frame(frame: Frame, data: bytes) -> dict[str, float]:
    """Return the physical value of each signal of a frame.

    Raises ValueError unless there are 8 bytes.
    """
    if len(data) != FRAME_BYTES:
        raise ValueError(f"{frame.name} has {len(data)} bytes, expected {FRAME_BYTES}")
    word = int.from_bytes(data, "little")
    values: dict[str, float] = {}
    for signal in frame.signals:
        raw = (word >> signal.start_bit) & signal.mask
        if raw > signal.highest:
            raw -= signal.mask + 1
        values[signal.name] = raw / signal.scale if signal.scale > 1 else raw
    return values


_USED_STATUS_BITS = sum(signal.mask << signal.start_bit for signal in STATUS.signals)


def _fault_of_status(data: bytes, values: dict[str, float]) -> Fault | None:
    if int.from_bytes(data, "little") & ~_USED_STATUS_BITS:
        return Fault.RESERVED_BITS
    if not values["frame_valid"]:
        return Fault.NOT_VALID
    if values["mode"] not in (OutputMode.CAN_ONLY, OutputMode.DDS_AND_CAN):
        return Fault.WRONG_MODE
    return None


def decode(frames: Sequence[CanFrame]) -> Decoded | Fault:
    """Return the command that three frames carry, or why they carry none.

    The frames must stand in the order of the table. Unused bits must be zero and the mode one that
    uses CAN: anything else was not made by the encoder. There is no jerk in the result.
    """
    if [frame.arbitration_id for frame in frames] != [row.arbitration_id for row in FRAMES]:
        return Fault.WRONG_FRAMES
    if any(len(frame.data) != FRAME_BYTES for frame in frames):
        return Fault.WRONG_LENGTH
    values: dict[str, float] = {}
    for row, frame in zip(FRAMES, frames, strict=True):
        values |= decode_frame(row, frame.data)
    if fault := _fault_of_status(frames[-1].data, values):
        return fault
    command = Command(
        steering_tire_angle=values["steering_tire_angle"],
        steering_tire_rotation_rate=values["steering_tire_rotation_rate"],
        velocity=values["velocity"],
        acceleration=values["acceleration"],
        is_defined_steering_tire_rotation_rate=bool(values["steering_rate_defined"]),
        is_defined_acceleration=bool(values["acceleration_defined"]),
        is_defined_jerk=bool(values["jerk_defined"]),
    )
    mode = OutputMode(int(values["mode"]))
    return Decoded(command, mode, int(values["sequence"]), int(values["timestamp"]))
