# SPDX-License-Identifier: Apache-2.0
"""The numbers of one tick that the page plots: one table of names, filled from a status."""

from __future__ import annotations

import math
from typing import NamedTuple

from safety_island.messages.status_fields import Status

AGES = ("trajectory_age", "odometry_age", "steering_age", "acceleration_age")
"""Of the inputs that have an age limit [s], in their order in the status."""
FIELDS = (
    "t",
    "lateral_error",
    "yaw_error",
    "speed",
    "target_speed",
    "steering",
    "command_angle",
    "acceleration",
    "command_acceleration",
    "jerk",
    "tick_time",
    "lateness",
    *AGES,
    "state",
    "longitudinal_state",
)
"""``t`` is the monitor's wall clock [s]; all else in m, rad, s and made of these; states as
numbers."""
DIGITS = 6
"""Significant digits of a number on its way to the page; ``t`` is rounded to 1 ms instead."""


class Measured(NamedTuple):
    """What the vehicle says of itself; NaN before it has."""

    speed: float = math.nan
    steering: float = math.nan
    acceleration: float = math.nan


class Jerk:
    """The change of the commanded acceleration from command to command [m/s^3]."""

    def __init__(self) -> None:
        self._last: tuple[float, float] | None = None

    def next(self, status: Status) -> float:
        """Return the jerk of this command; NaN without one before it."""
        at, value = status.stamp.seconds, status.command_acceleration
        last, self._last = self._last, None if math.isnan(value) else (at, value)
        if last is None or self._last is None or at <= last[0]:
            return math.nan
        return (value - last[1]) / (at - last[0])


def row(now: float, status: Status, measured: Measured, jerk: float) -> list[float]:
    """Return the numbers of one tick in the order of FIELDS."""
    ages = [item.age for item in status.inputs[: len(AGES)]]
    return [
        now,
        status.lateral_error,
        status.yaw_error,
        measured.speed,
        status.target_vel,
        measured.steering,
        status.command_angle,
        measured.acceleration,
        status.command_acceleration,
        jerk,
        status.tick_time,
        status.lateness,
        *ages,
        status.state,
        status.longitudinal_state,
    ]


def shortened(values: list[float]) -> list[float | None]:
    """Return a row as it is sent: rounded, None for what is not finite."""
    first, *rest = values
    return [round(first, 3), *(rounded(value) for value in rest)]


def rounded(value: float, digits: int = DIGITS) -> float | None:
    """Return a number with so many significant digits; None when it is not finite."""
    return float(f"{value:.{digits}g}") if math.isfinite(value) else None
