"""From the follower's record to the message, and what keeps a command from being sent."""

from __future__ import annotations

import math

from safety_island.control.records import Records
from safety_island.messages.outputs import Control
from safety_island.messages.wire import Time


def stale_side(lateral_stamp: float, record: Records, oldest: float) -> str:
    """Name the controller whose result is from before ``oldest``; empty when none is.

    All times are monotonic [s]. The record's own lateral stamp is set here: the kernels leave it.
    """
    record["stamp"] = lateral_stamp
    if not lateral_stamp >= oldest:
        return "lateral"
    if not record["longitudinal_stamp"][0] >= oldest:
        return "longitudinal"
    return ""


def to_control(record: Records, wall_offset_ns: int) -> Control:
    """Return the message of a COMMAND record, its stamps on the wall clock.

    The acceleration is always defined (the firmware leaves that flag unset), the jerk never.
    """
    stamp, longitudinal_stamp, angle, rate, velocity, acceleration, has_rate = record.item()
    return Control(
        Time.from_nanoseconds(int(stamp * 1e9) + wall_offset_ns),
        Time.from_nanoseconds(int(longitudinal_stamp * 1e9) + wall_offset_ns),
        angle,
        rate,
        velocity,
        acceleration,
        is_defined_steering_tire_rotation_rate=has_rate,
        is_defined_acceleration=True,
    )


def is_finite(command: Control) -> bool:
    """Whether the four numbers of a command are numbers (a sum of them is, when all are)."""
    return math.isfinite(
        command.steering_tire_angle
        + command.steering_tire_rotation_rate
        + command.velocity
        + command.acceleration
    )
