# SPDX-License-Identifier: Apache-2.0
"""A command on its way out, as the bytes of its message."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from safety_island.messages.outputs import Control, decode_control


def _value(name: str) -> Any:
    return property(lambda command: getattr(command.control, name))


class OutgoingControl:
    """A command that is to leave: its message, of which a value is read when it is asked for."""

    def __init__(self, message: bytes) -> None:
        """``message``: an ``autoware_control_msgs/msg/Control``."""
        self.message = message

    @cached_property
    def control(self) -> Control:
        """The message, decoded."""
        return decode_control(self.message)

    steering_tire_angle = _value("steering_tire_angle")
    steering_tire_rotation_rate = _value("steering_tire_rotation_rate")
    velocity = _value("velocity")
    acceleration = _value("acceleration")
    jerk = _value("jerk")
    is_defined_steering_tire_rotation_rate = _value("is_defined_steering_tire_rotation_rate")
    is_defined_acceleration = _value("is_defined_acceleration")
    is_defined_jerk = _value("is_defined_jerk")
