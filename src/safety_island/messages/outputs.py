# SPDX-License-Identifier: Apache-2.0
"""The messages that the island sends: the control command and a number for debugging."""

from __future__ import annotations

from struct import Struct
from typing import NamedTuple

from safety_island.messages.codec import of_size
from safety_island.messages.fixed import check_flags, layout, record_type
from safety_island.messages.wire import HEADER_LE, Time

CONTROL = "autoware_control_msgs/msg/Control"
FLOAT64_STAMPED = "tier4_debug_msgs/msg/Float64Stamped"
FLOAT32_STAMPED = "autoware_internal_debug_msgs/msg/Float32Stamped"

_RECORD = record_type(CONTROL)
_CONTROL = Struct("<4s" + layout(_RECORD))
_FLOAT64 = Struct("<4siId")
_FLOAT32 = Struct("<4siIf")


class Control(NamedTuple):
    """One command; the lateral part carries the stamp of the whole, as the firmware has it."""

    stamp: Time
    longitudinal_stamp: Time
    steering_tire_angle: float
    """[rad]"""
    steering_tire_rotation_rate: float
    """[rad/s]"""
    velocity: float
    """[m/s]"""
    acceleration: float
    """[m/s^2]"""
    jerk: float = 0.0
    """[m/s^3]"""
    is_defined_steering_tire_rotation_rate: bool = False
    is_defined_acceleration: bool = False
    is_defined_jerk: bool = False
    lateral_stamp: Time | None = None
    """None: the stamp of the whole."""


def encode_control(command: Control) -> bytes:
    """Return an autoware_control_msgs/msg/Control; every control_time is zero.

    Raises OverflowError for a finite value beyond float32 and struct.error for a stamp beyond its
    integers; NaN and infinity are encoded.
    """
    stamp, other, angle, rate, velocity, acceleration, jerk, *flags, lateral = command
    has_rate, has_acceleration, has_jerk = flags
    return _CONTROL.pack(
        HEADER_LE,
        *stamp,
        0,
        0,
        *(lateral or stamp),
        0,
        0,
        angle,
        rate,
        has_rate,
        *other,
        0,
        0,
        velocity,
        acceleration,
        jerk,
        has_acceleration,
        has_jerk,
    )


def decode_control(data: bytes) -> Control:
    """Return the command of an autoware_control_msgs/msg/Control; DecodeError when it is none."""
    data = of_size(data, _CONTROL.size, CONTROL)
    check_flags(data, _RECORD, CONTROL)
    found = _CONTROL.unpack_from(data)
    return Control(
        stamp=Time(*found[1:3]),
        longitudinal_stamp=Time(*found[12:14]),
        steering_tire_angle=found[9],
        steering_tire_rotation_rate=found[10],
        velocity=found[16],
        acceleration=found[17],
        jerk=found[18],
        is_defined_steering_tire_rotation_rate=found[11],
        is_defined_acceleration=found[19],
        is_defined_jerk=found[20],
        lateral_stamp=Time(*found[5:7]),
    )


def encode_float64_stamped(stamp: tuple[int, int], value: float) -> bytes:
    """Return a tier4_debug_msgs/msg/Float64Stamped; ``stamp`` in seconds and nanoseconds."""
    return _FLOAT64.pack(HEADER_LE, *stamp, value)


def encode_float32_stamped(stamp: tuple[int, int], value: float) -> bytes:
    """Return a Float32Stamped of autoware_internal_debug_msgs."""
    return _FLOAT32.pack(HEADER_LE, *stamp, value)


def decode_float32_stamped(data: bytes) -> tuple[Time, float]:
    """Return stamp and number of a Float32Stamped; DecodeError when it is none."""
    data = of_size(data, _FLOAT32.size, FLOAT32_STAMPED)
    _, sec, nanosec, value = _FLOAT32.unpack_from(data)
    return Time(sec, nanosec), value


def decode_float64_stamped(data: bytes) -> tuple[Time, float]:
    """Return stamp and number of a tier4_debug_msgs/msg/Float64Stamped."""
    data = of_size(data, _FLOAT64.size, FLOAT64_STAMPED)
    _, sec, nanosec, value = _FLOAT64.unpack_from(data)
    return Time(sec, nanosec), value
