# SPDX-License-Identifier: Apache-2.0
"""What the guard's records hold: names and types of their fields, in order.

NumPy makes record types of them outside, for the guard imports no code but its own.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from safety_island.guard.params import GuardParams

Columns = list[tuple[Any, ...]]
"""Name, type and, of an array, shape of each field; the type of a record within is its columns."""

MAX_SPEED_POINTS = 32
"""Entries that a list of limits by speed may have."""

LISTS = tuple(item.name for item in fields(GuardParams) if str(item.type).startswith("tuple"))
"""The parameters that are lists over speed, and the speeds themselves; all are of one length."""


def _parameters() -> Columns:
    names = [item.name for item in fields(GuardParams)]
    return [(n, "f8", (MAX_SPEED_POINTS,)) if n in LISTS else (n, "f8") for n in names]


PARAMETERS: Columns = [
    *_parameters(),
    ("points", "i8"),  # entries of each list
    ("wheel_base", "f8"),  # [m]
    ("timeout", "f8"),  # age beyond which a command is stale [s]
]
"""Every limit by its name."""

SENT: Columns = [
    ("exists", "?"),  # False: there is none, and the other fields say nothing
    ("now", "f8"),  # monotonic time of its check [s]
    ("angle", "f8"),  # [rad]
    ("slope", "f8"),  # tangent of the angle
    ("acceleration", "f8"),  # [m/s^2]
]
"""What the guard remembers of a command that it let through."""

STATE: Columns = [
    ("is_numbered", "?"),  # a command was let through before, so the next number must be higher
    ("sequence", "i8"),  # its number
    ("sent", SENT),  # the predecessor of the next command
    ("before", SENT),  # what that was before the last check
]
"""All memory of the guard; zeros are that of one that has judged nothing yet."""

PROPOSAL: Columns = [
    ("now", "f8"),  # monotonic [s]
    ("stamp", "f8"),  # monotonic stamp of the older half of the command [s]
    ("sequence", "i8"),  # number of this command, must rise
    ("steering_tire_angle", "f8"),  # [rad]
    ("steering_tire_rotation_rate", "f8"),  # [rad/s]
    ("velocity", "f8"),  # [m/s]
    ("acceleration", "f8"),  # along the direction of driving: below zero it brakes [m/s^2]
    ("speed", "f8"),  # measured, below zero in reverse [m/s]
    ("steering", "f8"),  # measured [rad]
    ("engaged", "?"),  # the vehicle follows the commands
]
"""A command as the controllers want to send it, and what was measured."""

DECISION: Columns = [
    ("verdict", "i4"),  # Verdict
    ("limits", "i4"),  # bits of Limit
    ("steering_tire_angle", "f8"),  # [rad]
    ("steering_tire_rotation_rate", "f8"),  # [rad/s]
    ("velocity", "f8"),  # [m/s]
    ("acceleration", "f8"),  # [m/s^2]
]
"""What may be sent; of a refused command every value is NaN, for there is none to send."""
