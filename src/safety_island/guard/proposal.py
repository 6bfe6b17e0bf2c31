# SPDX-License-Identifier: Apache-2.0
"""What the guard is asked, and what it answers."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.guard.limit import Verdict


class Proposal(NamedTuple):
    """A command as the controllers want to send it.

    The acceleration is that along the direction of driving: below zero it brakes, in reverse too.
    """

    now: float  # monotonic [s]
    stamp: float  # monotonic stamp of the older half of the command [s]
    sequence: int  # number of this command, must rise
    steering_tire_angle: float  # [rad]
    steering_tire_rotation_rate: float  # [rad/s]
    velocity: float  # [m/s]
    acceleration: float  # [m/s^2]


class Decision(NamedTuple):
    """What may be sent; of a refused command every value is NaN, for there is none to send."""

    verdict: Verdict
    limits: int  # bits of Limit
    steering_tire_angle: float  # [rad]
    steering_tire_rotation_rate: float  # [rad/s]
    velocity: float  # [m/s]
    acceleration: float  # [m/s^2]
