# SPDX-License-Identifier: Apache-2.0
"""Encoder of the three frames: a pure function that follows the table of ``frames``."""

from __future__ import annotations

from math import isfinite
from typing import NamedTuple

from safety_island.can.command import Cause, Command
from safety_island.can.frames import FRAME_BYTES, FRAMES, STATUS, Frame, Signal, limits_text
from safety_island.can.mode import OutputMode
from safety_island.platform.interfaces import CanFrame

NS_PER_MS = 1_000_000

Triple = tuple[CanFrame, ...]
"""The three frames of a command in the order of ``FRAMES``; empty when the mode uses no CAN."""


class Rejection(NamedTuple):
    """Why no frame of a command exists: the first value that cannot be encoded."""

    arbitration_id: int
    signal: str
    value: float
    cause: Cause

    def describe(self) -> str:
        """Say what was found and what was expected."""
        if self.cause is Cause.NOT_FINITE:
            return f"{self.signal} is {self.value}, expected a finite number"
        allowed = limits_text(self.signal)
        return f"{self.signal} is {self.value:.10g}, expected {allowed} (int32 after scaling)"


def quantise(value: float, signal: Signal) -> int | Cause:
    """Return value x scale as a raw integer, rounded half away from zero, or why that fails.

    The product is formed in double precision, so it is exact for a value of single precision.
    """
    scaled = float(value) * signal.scale
    if not isfinite(scaled):
        return Cause.OUT_OF_RANGE if isfinite(value) else Cause.NOT_FINITE
    raw = int(scaled)
    rest = scaled - raw
    if rest >= 0.5:
        raw += 1
    elif rest <= -0.5:
        raw -= 1
    return raw if signal.lowest <= raw <= signal.highest else Cause.OUT_OF_RANGE


def _pack(frame: Frame, values: dict[str, float]) -> CanFrame | Rejection:
    word = 0
    for signal in frame.signals:
        value = values[signal.name]
        # A scaled value must fit; a counter wraps.
        raw = quantise(value, signal) if signal.scale > 1 else int(value)
        if isinstance(raw, Cause):
            return Rejection(frame.arbitration_id, signal.name, value, raw)
        word |= (raw & signal.mask) << signal.start_bit
    return CanFrame(frame.arbitration_id, word.to_bytes(FRAME_BYTES, "little"))


def encode(command: Command, mode: OutputMode, sequence: int, stamp_ns: int) -> Triple | Rejection:
    """Return the frames of a command: three, none when the mode uses no CAN, or a rejection.

    ``sequence`` counts modulo 65536; ``stamp_ns`` is the stamp of the command [ns], sent in whole
    milliseconds modulo 2^32. A value that is not finite or does not fit int32 rejects the command
    before any frame exists; so does a jerk that is defined and not finite.
    """
    if not mode.uses_can:
        return ()
    if command.is_defined_jerk and not isfinite(command.jerk):
        return Rejection(STATUS.arbitration_id, "jerk", command.jerk, Cause.NOT_FINITE)
    values: dict[str, float] = {
        "steering_tire_angle": command.steering_tire_angle,
        "steering_tire_rotation_rate": command.steering_tire_rotation_rate,
        "velocity": command.velocity,
        "acceleration": command.acceleration,
        "mode": mode,
        "steering_rate_defined": command.is_defined_steering_tire_rotation_rate,
        "acceleration_defined": command.is_defined_acceleration,
        "jerk_defined": command.is_defined_jerk,
        "frame_valid": 1,
        "sequence": sequence,
        "timestamp": stamp_ns // NS_PER_MS,
    }
    frames = []
    for frame in FRAMES:
        packed = _pack(frame, values)
        if isinstance(packed, Rejection):
            return packed
        frames.append(packed)
    return tuple(frames)
