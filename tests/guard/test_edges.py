# SPDX-License-Identifier: Apache-2.0
"""Every limit up to its edge: there nothing acts, a hair beyond it that limit alone does."""

from __future__ import annotations

from math import atan
from typing import Any

import pytest

from safety_island.core.guard import Guard, Proposal
from safety_island.guard import Limit
from tests.guard.rig import TIMEOUT, WHEEL_BASE, limited

LIMITS = limited(
    speed_points=(0.0, 4.0),
    steering_angle=(0.5, 0.75),
    steering_rate=(1.5, 1.0),
    rotation_rate=(0.25, 0.5),
    steering_distance=(0.125, 0.25),
    lateral_acceleration=(2.0, 3.0),
    lateral_jerk=(4.0, 5.0),
    acceleration=(2.0, 1.0),
    deceleration=(4.0, 3.0),
    jerk=(2.0, 2.0),
    brake_jerk=(8.0, 8.0),
    velocity=8.0,
    shortest_step=0.0625,
    longest_step=1.0,
)
NEAR = 1e-9


def acting(
    command: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0),
    sent: tuple[float, float] = (0.0, 0.0),
    speed: float = 0.0,
    steering: float = 0.0,
    step: float = 0.5,
) -> Limit:
    """The limits that act on a command ``step`` [s] after one of (angle, acceleration)."""
    guard = Guard(LIMITS, WHEEL_BASE, TIMEOUT)
    first = Proposal(10.0, 10.0, 1, sent[0], 0.0, 0.0, sent[1])
    assert not guard.check(first, 0.0, sent[0]).limits
    now = 10.0 + step
    return Limit(guard.check(Proposal(now, now, 2, *command), speed, steering).limits)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("place", "edge", "at", "limit"),
    [
        (0, 0.5, {"steering": 0.5, "sent": (0.5, 0.0)}, Limit.ANGLE),
        (0, 0.125, {}, Limit.STEERING_DISTANCE),
        (0, 0.09375, {"step": 0.0625}, Limit.RATE),
        (1, 0.25, {}, Limit.ROTATION_RATE),
        (2, 8.0, {}, Limit.VELOCITY),
    ],
    ids=["angle", "distance", "rate", "rotation rate", "velocity"],
)
def test_what_is_limited_both_ways_alike(
    place: int, edge: float, at: dict[str, Any], limit: Limit, sign: float
) -> None:
    at = at | {"steering": sign * at.get("steering", 0.0)}
    at |= {"sent": (sign * at.get("sent", (0.0, 0.0))[0], 0.0)}

    def limits_at(value: float) -> Limit:
        values = [0.0] * 4
        values[place] = sign * value
        return acting(tuple(values), **at)

    assert not limits_at(edge)
    assert limits_at(edge + NEAR) == limit


@pytest.mark.parametrize(
    ("edge", "at", "limit"),
    [
        (2.0, {"sent": (0.0, 2.0)}, Limit.ACCELERATION),
        (-4.0, {"sent": (0.0, -4.0)}, Limit.ACCELERATION),
        (0.5, {"step": 0.25}, Limit.JERK),
        (-2.0, {"step": 0.25}, Limit.JERK),
    ],
    ids=["drive", "brake", "jerk", "brake jerk"],
)
def test_acceleration_and_its_change(edge: float, at: dict[str, Any], limit: Limit) -> None:
    assert not acting((0.0, 0.0, 0.0, edge), **at)
    assert acting((0.0, 0.0, 0.0, edge + (NEAR if edge > 0.0 else -NEAR)), **at) == limit


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("speed", [8.0, -8.0])
def test_lateral_acceleration(sign: float, speed: float) -> None:
    edge = atan(3.0 * WHEEL_BASE / 64.0)
    for angle, expected in ((edge, Limit(0)), (edge + NEAR, Limit.LATERAL_ACCELERATION)):
        at: dict[str, Any] = {"sent": (sign * 0.115, 0.0), "speed": speed, "steering": 0.0}
        assert acting((sign * angle, 0.0, 0.0, 0.0), **at) == expected


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("speed", [8.0, -8.0])
def test_lateral_jerk(sign: float, speed: float) -> None:
    edge = atan(5.0 * 0.25 * WHEEL_BASE / 64.0)
    for angle, expected in ((edge, Limit(0)), (edge + NEAR, Limit.LATERAL_JERK)):
        assert acting((sign * angle, 0.0, 0.0, 0.0), speed=speed, step=0.25) == expected


@pytest.mark.parametrize("speed", [8.0, -8.0])
def test_the_highest_speed(speed: float) -> None:
    at: dict[str, Any] = {"command": (0.0, 0.0, 0.0, 0.5), "sent": (0.0, 0.5)}
    assert not acting(speed=speed, **at)
    assert acting(speed=speed * (1.0 + NEAR), **at) == Limit.VELOCITY


@pytest.mark.parametrize(("speed", "velocity"), [(1.0, -1.0), (-1.0, 1.0)])
def test_the_other_way_than_it_rolls(speed: float, velocity: float) -> None:
    command = (0.0, 0.0, velocity, 0.25)
    assert acting(command, speed=speed) == Limit.VELOCITY
    assert not acting(command, speed=-speed)
    assert not acting(command, speed=speed / 2.0)  # at rolling_speed


def test_in_reverse_the_limits_are_those_of_the_same_speed_forward() -> None:
    """Beyond the last point braking may be 3 m/s^2, at standstill 4."""
    at: dict[str, Any] = {"sent": (0.0, -2.5), "speed": -6.0}
    assert not acting((0.0, 0.0, -6.0, -3.0), **at)
    assert acting((0.0, 0.0, -6.0, -3.5), **at) == Limit.ACCELERATION


def test_what_is_measured_goes_where_it_belongs() -> None:
    """At 8 m/s this angle pushes the vehicle aside too hard; at 0.1 m/s it would not."""
    at: dict[str, Any] = {"sent": (0.1, 0.0), "steering": 0.1}
    assert acting((0.12, 0.0, 0.0, 0.0), speed=8.0, **at) == Limit.LATERAL_ACCELERATION
    assert not acting((0.12, 0.0, 0.0, 0.0), speed=0.1, **at)


def test_the_distance_is_that_from_the_measured_angle() -> None:
    assert acting(speed=2.0, steering=0.5) == Limit.STEERING_DISTANCE


def test_after_one_that_passed_limits_count_from_it() -> None:
    at: dict[str, Any] = {"sent": (0.1, 1.0), "step": 0.0625, "steering": 0.1}
    assert not acting((0.15, 0.0, 0.0, 1.1), **at)
    assert acting((0.2, 0.0, 0.0, 1.2), **at) == Limit.RATE | Limit.JERK
