"""A command as CAN carries it, and the causes for which one is not sent."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple


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
