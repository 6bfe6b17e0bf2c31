# SPDX-License-Identifier: Apache-2.0
"""What the guard decides, and every check that it makes: what it means and what to do.

The table makes docs/guard.md; the bits are those of the status message.
"""

from __future__ import annotations

from enum import IntEnum, IntFlag


class Verdict(IntEnum):
    """What becomes of a command."""

    PASSED = 0
    """It is sent as it is, bit for bit."""
    CLAMPED = 1
    """It is sent with the nearest values that the limits allow."""
    REFUSED = 2
    """It is not sent, and leaves no trace in the guard."""


class Limit(IntFlag):
    """One bit for each check."""

    ANGLE = 1
    RATE = 2
    ROTATION_RATE = 4
    STEERING_DISTANCE = 8
    LATERAL_ACCELERATION = 16
    LATERAL_JERK = 32
    ACCELERATION = 64
    JERK = 128
    VELOCITY = 256
    NOT_FINITE = 512
    STALE = 1024
    SEQUENCE = 2048


REFUSALS = Limit.NOT_FINITE | Limit.STALE | Limit.SEQUENCE
"""The checks that refuse; all others clamp."""

_STEERING = "look at the trajectory for a jump, and at the solver status of the MPC"
_PEDALS = "look at the state of the longitudinal controller and at the trajectory's speeds"

EXPLANATIONS: dict[Limit, tuple[str, str]] = {
    Limit.ANGLE: (
        "the steering angle is larger than the vehicle may be told",
        "let `max_steer_angle` and `guard.steering_angle` fit the vehicle",
    ),
    Limit.RATE: ("the steering angle moves too fast from command to command", _STEERING),
    Limit.ROTATION_RATE: ("the steering rate that goes with the angle is too large", _STEERING),
    Limit.STEERING_DISTANCE: (
        "the steering angle is too far from the measured one",
        "look whether the steering follows, and whether its sensor is right",
    ),
    Limit.LATERAL_ACCELERATION: (
        "at this speed the steering angle would push the vehicle aside too hard",
        "let the planner take the curve slower; " + _STEERING,
    ),
    Limit.LATERAL_JERK: (
        "at this speed the change of the steering angle would jerk the vehicle aside",
        _STEERING,
    ),
    Limit.ACCELERATION: ("it drives off or brakes too hard", _PEDALS),
    Limit.JERK: ("the acceleration changes too fast from command to command", _PEDALS),
    Limit.VELOCITY: (
        "the speed that is asked for, or the vehicle's own, is above the limit, or the vehicle"
        " rolls the other way",
        "look at the trajectory's speeds",
    ),
    Limit.NOT_FINITE: (
        "a value of the command, or the measured speed or angle, is NaN or infinite",
        "report it: a fault of the program",
    ),
    Limit.STALE: (
        "the command is older than `timeout_thr_sec`, or its stamp lies in the future",
        "look at the tick time and the lateness in the status",
    ),
    Limit.SEQUENCE: (
        "the number of the command has not risen, or time ran backward since the last one",
        "report it: a fault of the program",
    ),
}
"""Check -> what it means when it acts, what to do."""
