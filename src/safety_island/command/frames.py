# SPDX-License-Identifier: Apache-2.0
"""The frames of a command: identifier, bits, scale and unit of every signal, in one table.

Source: the CAN output contract of the safety island. All frames are classic CAN with a standard
identifier and 8 bytes; all signals are little endian.
"""

from __future__ import annotations

from typing import NamedTuple

from safety_island.command.mode import OutputMode

FRAME_BYTES = 8


class Signal(NamedTuple):
    """One number in a frame: raw = value x scale, at ``start_bit`` (bit 0: lowest of byte 0)."""

    name: str
    start_bit: int
    bits: int
    signed: bool
    scale: int
    unit: str
    meaning: str
    choices: tuple[tuple[int, str], ...]
    mask: int
    """A one for each bit."""
    lowest: int
    """Lowest raw value."""
    highest: int
    """Highest raw value."""


class Frame(NamedTuple):
    """One of the three frames."""

    arbitration_id: int
    name: str
    meaning: str
    signals: tuple[Signal, ...]


def _signal(
    name: str,
    start_bit: int,
    bits: int,
    unit: str,
    meaning: str,
    signed: bool = False,
    scale: int = 1,
    choices: tuple[tuple[int, str], ...] = (),
) -> Signal:
    mask = (1 << bits) - 1
    lowest, highest = (-(mask // 2) - 1, mask // 2) if signed else (0, mask)
    return Signal(
        name, start_bit, bits, signed, scale, unit, meaning, choices, mask, lowest, highest
    )


def _value(name: str, start_bit: int, scale: int, unit: str, meaning: str) -> Signal:
    return _signal(name, start_bit, 32, unit, meaning, signed=True, scale=scale)


def _flag(name: str, start_bit: int, meaning: str) -> Signal:
    return _signal(name, start_bit, 1, "", meaning)


_MODES = tuple((mode.value, mode.name) for mode in OutputMode)

LATERAL = Frame(
    0x100,
    "LATERAL_COMMAND",
    "First frame of a command: steering.",
    (
        _value("steering_tire_angle", 0, 1_000_000, "rad", "Angle of the front tyres, left is +."),
        _value("steering_tire_rotation_rate", 32, 1_000_000, "rad/s", "Rate of that angle."),
    ),
)
LONGITUDINAL = Frame(
    0x101,
    "LONGITUDINAL_COMMAND",
    "Second frame of a command: speed.",
    (
        _value("velocity", 0, 1_000, "m/s", "Speed, forward is +."),
        _value("acceleration", 32, 1_000, "m/s^2", "Acceleration, forward is +."),
    ),
)
STATUS = Frame(
    0x102,
    "COMMAND_STATUS",
    "Third frame of a command: what the two before it mean and when they were made.",
    (
        _signal("mode", 0, 8, "", "Output mode of the island.", choices=_MODES),
        _flag("steering_rate_defined", 8, "1: steering_tire_rotation_rate is part of the command."),
        _flag("acceleration_defined", 9, "1: acceleration is part of the command."),
        _flag("jerk_defined", 10, "1: the DDS command has a jerk (no frame carries it)."),
        _flag("frame_valid", 11, "Always 1."),
        _signal("sequence", 16, 16, "", "Number of the command, wraps after 65535."),
        _signal("timestamp", 32, 32, "ms", "Stamp of the command modulo 2^32."),
    ),
)

FRAMES = (LATERAL, LONGITUDINAL, STATUS)
"""The frames of one command in the order in which they are sent."""

COMMAND_IDS = frozenset(frame.arbitration_id for frame in FRAMES)

CHECKSUM_ID = 0x103
"""Kept free for a frame with a checksum of the three; whoever sends it commands the vehicle."""
WATCHED_IDS = COMMAND_IDS | {CHECKSUM_ID}
"""Identifiers that no other node may send."""


def limits_text(name: str) -> str:
    """Return the range of a signal in its unit, for a message to a user."""
    signal = next(s for frame in FRAMES for s in frame.signals if s.name == name)
    low, high = signal.lowest / signal.scale, signal.highest / signal.scale
    return f"{low:.10g} to {high:.10g} {signal.unit}".rstrip()
