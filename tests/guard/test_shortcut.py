# SPDX-License-Identifier: Apache-2.0
"""What passes at once: each limit up to its edge, and nothing that the full way would change."""

from __future__ import annotations

from math import tan
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from safety_island.guard import Decision, Guard, Limit, Proposal, Verdict
from safety_island.guard.shortcut import Shortcut
from safety_island.guard.table import SpeedTable
from tests.guard.rig import TIMEOUT, WHEEL_BASE, Stream, limited

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
)
NEAR = 1e-9
SLACK = 1e-12
"""Two ways to sum the same may differ by that."""


def keeps(
    command: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    sent: tuple[float, float] = (0.0, 0.0),
    slopes: tuple[float, float] = (0.0, 0.0),
    speed: float = 1.0,
    steering: float = 0.0,
    step: float = 0.5,
) -> bool:
    """Whether a command passes after one of (angle, acceleration); ``slopes`` of both."""
    shortcut = Shortcut(SpeedTable(LIMITS), LIMITS.velocity, WHEEL_BASE)
    before = 10.0, sent[0], slopes[0], sent[1]
    return shortcut.keeps_all(
        Proposal(10.5, 10.5, 2, *command), slopes[1], before, speed, steering, step
    )


def test_a_command_of_zeros_passes() -> None:
    assert keeps()


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("place", "edge", "at"),
    [
        (0, 0.5, {"steering": 0.5, "sent": (0.5, 0.0)}),
        (0, 0.125, {}),
        (0, 0.0625, {"step": 0.0625}),
        (1, 0.25, {}),
        (2, 8.0, {"speed": 0.0}),
    ],
    ids=["angle", "distance", "rate", "rotation rate", "velocity"],
)
def test_what_is_limited_both_ways_alike(
    place: int, edge: float, at: dict[str, Any], sign: float
) -> None:
    if "steering" in at:
        at = {"steering": sign * at["steering"], "sent": (sign * at["sent"][0], 0.0)}

    def passes(value: float) -> bool:
        values = [0.0] * 4
        values[place] = sign * value
        return keeps((values[0], values[1], values[2], values[3]), **at)

    assert passes(edge)
    assert not passes(edge + NEAR)


@pytest.mark.parametrize(
    ("edge", "at"),
    [
        (1.0, {"sent": (0.0, 1.0)}),
        (-3.0, {"sent": (0.0, -3.0)}),
        (0.5, {"step": 0.25}),
        (-2.0, {"step": 0.25}),
    ],
    ids=["drive", "brake", "jerk", "brake jerk"],
)
def test_acceleration_and_its_change(edge: float, at: dict[str, Any]) -> None:
    assert keeps((0.0, 0.0, 0.0, edge), **at)
    assert not keeps((0.0, 0.0, 0.0, edge + (NEAR if edge > 0.0 else -NEAR)), **at)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("speed", [2.0, -2.0])
def test_lateral_acceleration(sign: float, speed: float) -> None:
    edge = 2.0 * WHEEL_BASE / 4.0
    for slope, expected in ((edge, True), (edge + NEAR, False)):
        assert keeps(slopes=(sign * slope, sign * slope), speed=speed) is expected


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("speed", [2.0, -2.0])
def test_lateral_jerk(sign: float, speed: float) -> None:
    edge = 4.0 * 0.25 * WHEEL_BASE / 4.0
    for slope, expected in ((edge, True), (edge + NEAR, False)):
        assert keeps(slopes=(0.0, sign * slope), speed=speed, step=0.25) is expected


@pytest.mark.parametrize("speed", [8.0, -8.0])
def test_the_highest_speed(speed: float) -> None:
    assert keeps(speed=speed)
    assert not keeps(speed=speed * (1.0 + NEAR))


@pytest.mark.parametrize(("speed", "velocity"), [(1.0, -1.0), (-1.0, 1.0)])
def test_the_other_way_than_it_rolls(speed: float, velocity: float) -> None:
    assert not keeps((0.0, 0.0, velocity, 0.0), speed=speed)
    assert keeps((0.0, 0.0, velocity, 0.0), speed=-speed)


def test_in_reverse_the_limits_are_those_of_the_same_speed_forward() -> None:
    """Beyond the last point braking may be 3 m/s^2, at standstill 4."""
    at: dict[str, Any] = {"sent": (0.0, -2.5), "speed": -6.0}
    assert keeps((0.0, 0.0, -6.0, -3.0), **at)
    assert not keeps((0.0, 0.0, -6.0, -3.5), **at)


_wheel = st.floats(-0.2, 0.2)
_speed = st.floats(-9.0, 9.0)
_stream = st.lists(
    st.tuples(
        st.floats(0.02, 0.5),
        st.tuples(_wheel, st.floats(-0.3, 0.3), _speed, st.floats(-4.0, 2.0)),
        _speed,
        _wheel,
    ),
    min_size=2,
    max_size=8,
)


def _full() -> Guard:
    guard = Guard(LIMITS, WHEEL_BASE, TIMEOUT)
    guard._keeps_all = lambda *_: False
    return guard


@given(_stream)
@example([(0.5, (0.0, 0.0, -6.0, 0.0), -6.0, 0.0), (0.4, (0.0, 0.0, -6.0, -3.1), -6.0, 0.0)])
def test_shortcut_on_is_shortcut_off_at_every_speed(stream: list[Any]) -> None:
    """Forward and in reverse; what passes at once would pass in full too."""
    usual, full = Guard(LIMITS, WHEEL_BASE, TIMEOUT), _full()
    now = 10.0
    for number, (wait, values, speed, steering) in enumerate(stream):
        now += wait
        proposal = Proposal(now, now, number, *values)
        found = usual.check(proposal, speed, steering)
        expected = full.check(proposal, speed, steering)
        _agree(found, expected)
        full._sent = usual._sent  # the last bit of one must not add up


def _agree(found: Decision, expected: Decision) -> None:
    if found.verdict is Verdict.PASSED:
        assert found[2:] == pytest.approx(expected[2:], abs=SLACK, rel=SLACK)
    else:
        assert repr(found) == repr(expected)


def test_what_is_measured_goes_where_it_belongs() -> None:
    """At 2 m/s this angle pushes the vehicle aside too hard; at 0.1 m/s it would not."""
    stream = Stream(lateral_acceleration=0.5)
    assert stream.send(0.0, speed=2.0).verdict is Verdict.PASSED
    found = stream.send(0.4, speed=2.0, steering=0.1)
    assert found.limits == Limit.LATERAL_ACCELERATION
    assert tan(found.steering_tire_angle) == pytest.approx(0.5 * WHEEL_BASE / 4.0)


def test_the_distance_is_that_from_the_measured_angle() -> None:
    stream = Stream(steering_distance=0.25)
    stream.send(0.0, speed=2.0)
    assert stream.send(0.0, speed=2.0, steering=0.5).limits == Limit.STEERING_DISTANCE


def test_after_one_that_passed_at_once_limits_count_from_it() -> None:
    guard = Guard(LIMITS, WHEEL_BASE, TIMEOUT)
    guard.check(Proposal(10.0, 10.0, 1, 0.05, 0.0, 0.0, 0.0), 1.0, 0.05)
    guard.check(Proposal(10.1, 10.1, 2, 0.0625, 0.0, 0.0, 0.125), 1.0, 0.05)
    assert guard._sent == (10.1, 0.0625, tan(0.0625), 0.125)


def test_speed_and_steering_as_measured_are_not_mixed_up() -> None:
    """At 0.2 m/s with the wheel at -0.3 rad: either for the other lets 0.2 rad pass at once."""
    guard = Guard(LIMITS, WHEEL_BASE, TIMEOUT)
    assert (
        guard.check(Proposal(10.0, 10.0, 1, 0.2, 0.0, 0.0, 0.0), 0.2, 0.2).verdict is Verdict.PASSED
    )
    found = guard.check(Proposal(10.1, 10.1, 2, 0.2, 0.0, 0.0, 0.0), 0.2, -0.3)
    assert found.verdict is Verdict.CLAMPED
