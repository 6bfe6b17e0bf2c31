# SPDX-License-Identifier: Apache-2.0
"""A command as CAN carries it, and the causes for which one is not sent."""

from __future__ import annotations

import struct
from enum import StrEnum
from typing import NamedTuple, Protocol

_SINGLES = struct.Struct("<5f")


class Cause(StrEnum):
    """Why a command did not leave as three frames."""

    NOT_FINITE = "not_finite"
    OUT_OF_RANGE = "out_of_range"
    QUEUE_FULL = "queue_full"
    TIMED_OUT = "timed_out"
    BUS_OFF = "bus_off"
    INTERFACE_DOWN = "interface_down"
    NOT_OPEN = "not_open"
    FAILED = "failed"


class ControlFields(Protocol):
    """What CAN output reads of a command; the message ``Control`` has these fields and more."""

    @property
    def steering_tire_angle(self) -> float:
        """[rad]."""

    @property
    def steering_tire_rotation_rate(self) -> float:
        """[rad/s]."""

    @property
    def velocity(self) -> float:
        """[m/s]."""

    @property
    def acceleration(self) -> float:
        """[m/s^2]."""

    @property
    def jerk(self) -> float:
        """[m/s^3]."""

    @property
    def is_defined_steering_tire_rotation_rate(self) -> bool:
        """Whether the rate counts."""

    @property
    def is_defined_acceleration(self) -> bool:
        """Whether the acceleration counts."""

    @property
    def is_defined_jerk(self) -> bool:
        """Whether the jerk counts."""


class Command(NamedTuple):
    """The part of ``autoware_control_msgs/msg/Control`` that CAN carries, in SI units.

    An undefined value is encoded as it stands; only its flag says that it does not count.
    """

    steering_tire_angle: float = 0.0
    steering_tire_rotation_rate: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0
    jerk: float = 0.0
    is_defined_steering_tire_rotation_rate: bool = False
    is_defined_acceleration: bool = False
    is_defined_jerk: bool = False


def as_published(command: ControlFields) -> Command:
    """Return the command in single precision, as the DDS message carries it.

    So the frames agree with ``control_cmd`` to the last scaled digit.
    """
    numbers = (
        command.steering_tire_angle,
        command.steering_tire_rotation_rate,
        command.velocity,
        command.acceleration,
        command.jerk,
    )
    try:
        singles = _SINGLES.unpack(_SINGLES.pack(*numbers))
    except OverflowError:  # beyond single precision, hence beyond int32: the encoder rejects it
        singles = numbers
    return Command._make(
        (
            *singles,
            command.is_defined_steering_tire_rotation_rate,
            command.is_defined_acceleration,
            command.is_defined_jerk,
        )
    )
