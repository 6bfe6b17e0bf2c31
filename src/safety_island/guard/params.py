# SPDX-License-Identifier: Apache-2.0
"""Parameters of the guard."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from safety_island.parameter import parameter

NO_LIMIT = 1e12
"""More than any command of the controllers comes to, whatever their parameters and inputs are."""


def _limit(name: str, unit: str, doc: str, high: float = NO_LIMIT) -> Any:
    """Declare a limit by speed; 0 would hold the vehicle for good, so no limit may be that."""
    return parameter(unit, doc, 0.001, high, key=f"guard.{name}")


@dataclass(frozen=True)
class GuardParams:
    """The guard (``guard.param.yaml``)."""

    speed_points: tuple[float, ...] = parameter(
        "m/s",
        "Measured speeds at which the guard's lists give their limits: linear between them, held"
        " outside.",
        0.0,
        100.0,
        key="guard.speed_points",
    )
    steering_angle: tuple[float, ...] = _limit(
        "steering_angle", "rad", "Largest steering angle, either side.", 1.57
    )
    steering_rate: tuple[float, ...] = _limit(
        "steering_rate", "rad/s", "Largest change of the steering angle with time."
    )
    rotation_rate: tuple[float, ...] = _limit(
        "rotation_rate", "rad/s", "Largest steering rate that is sent with the angle."
    )
    steering_distance: tuple[float, ...] = _limit(
        "steering_distance", "rad", "Largest distance of the angle from the measured one.", 200.0
    )
    lateral_acceleration: tuple[float, ...] = _limit(
        "lateral_acceleration", "m/s^2", "Largest lateral acceleration, speed^2 x curvature."
    )
    lateral_jerk: tuple[float, ...] = _limit(
        "lateral_jerk", "m/s^3", "Largest lateral jerk, speed^2 x change of curvature."
    )
    acceleration: tuple[float, ...] = _limit(
        "acceleration", "m/s^2", "Largest acceleration that drives."
    )
    deceleration: tuple[float, ...] = _limit(
        "deceleration", "m/s^2", "Largest acceleration that brakes."
    )
    jerk: tuple[float, ...] = _limit("jerk", "m/s^3", "Largest rise of the acceleration with time.")
    brake_jerk: tuple[float, ...] = _limit(
        "brake_jerk", "m/s^3", "Largest growth of braking with time."
    )
    velocity: float = _limit("velocity", "m/s", "Largest speed, asked for or measured.", 200.0)
    rolling_speed: float = _limit(
        "rolling_speed",
        "m/s",
        "Measured speed above which nothing may drive the other way than the vehicle rolls.",
        200.0,
    )
    shortest_step: float = parameter(
        "s",
        "Time between two commands that counts when they come closer, down to half of it.",
        0.001,
        1.0,
        key="guard.shortest_step",
    )
    longest_step: float = parameter(
        "s",
        "Time between two commands that counts when they come further apart.",
        0.001,
        10.0,
        key="guard.longest_step",
    )
