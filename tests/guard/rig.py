# SPDX-License-Identifier: Apache-2.0
"""A guard with round limits, and a stream of commands for it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from safety_island.core.guard import Decision, Guard, Proposal
from safety_island.guard import GuardParams

WHEEL_BASE, TIMEOUT, PERIOD = 2.5, 0.5, 0.1

WIDE = GuardParams(
    speed_points=(0.0, 10.0),
    steering_angle=(1.0, 1.0),
    steering_rate=(100.0, 100.0),
    rotation_rate=(100.0, 100.0),
    steering_distance=(3.0, 3.0),
    lateral_acceleration=(1e6, 1e6),
    lateral_jerk=(1e9, 1e9),
    acceleration=(20.0, 20.0),
    deceleration=(20.0, 20.0),
    jerk=(500.0, 500.0),
    brake_jerk=(500.0, 500.0),
    velocity=50.0,
    rolling_speed=0.5,
    shortest_step=0.1,
    longest_step=0.4,
)
"""Limits that a test narrows one at a time."""

SINGLE = ("velocity", "rolling_speed", "shortest_step", "longest_step")
"""Limits that are one number at every speed."""


def limited(**limits: Any) -> GuardParams:
    """WIDE with some limits changed; a number stands for a list of it."""
    lists: dict[str, Any] = {
        name: (value, value) if isinstance(value, float) and name not in SINGLE else value
        for name, value in limits.items()
    }
    return replace(WIDE, **lists)


class Stream:
    """Commands PERIOD apart, each as old as the tick that it is for."""

    def __init__(self, **limits: Any) -> None:
        self.guard = Guard(limited(**limits), WHEEL_BASE, TIMEOUT)
        self.now, self.sequence = 100.0, 0

    def send(
        self,
        angle: float = 0.0,
        rotation: float = 0.0,
        velocity: float = 0.0,
        acceleration: float = 0.0,
        *,
        speed: float = 0.0,
        steering: float = 0.0,
        wait: float = PERIOD,
        engaged: bool = True,
    ) -> Decision:
        """Offer the next command, ``wait`` after the one before."""
        self.now += wait
        self.sequence += 1
        proposal = Proposal(
            self.now, self.now, self.sequence, angle, rotation, velocity, acceleration
        )
        return self.guard.check(proposal, speed, steering, engaged)
