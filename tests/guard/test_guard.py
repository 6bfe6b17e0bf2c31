# SPDX-License-Identifier: Apache-2.0
"""Every check of the guard, against values worked out by hand."""

from __future__ import annotations

from math import atan, copysign, inf, isnan, nan, tan
from typing import Any

import pytest

from safety_island.core.guard import Decision, Guard, Proposal
from safety_island.guard import Limit, Verdict
from tests.guard.rig import TIMEOUT, WHEEL_BASE, WIDE, Stream, limited

COMMAND = Proposal(10.0, 10.0, 1, 0.1, 0.2, 3.0, -0.4)


def decided(found: Decision, verdict: Verdict, limits: Limit | int = 0) -> Decision:
    """Hold a decision's verdict and bits; return it."""
    assert (found.verdict, Limit(found.limits)) == (verdict, Limit(limits))
    return found


def refused(
    guard: Guard, proposal: Proposal, limits: Limit, speed: float = 0.0, steering: float = 0.0
) -> None:
    found = decided(guard.check(proposal, speed, steering), Verdict.REFUSED, limits)
    assert all(map(isnan, found[2:]))


def fresh() -> Guard:
    return Guard(WIDE, WHEEL_BASE, TIMEOUT)


def test_a_good_command_passes_bit_for_bit() -> None:
    found = decided(fresh().check(COMMAND, 3.0, 0.1), Verdict.PASSED)
    assert found[2:] == COMMAND[3:]


@pytest.mark.parametrize("value", [nan, inf, -inf])
@pytest.mark.parametrize("name", [name for name in Proposal._fields if name != "sequence"])
def test_a_command_that_is_not_finite_is_refused(name: str, value: Any) -> None:
    refused(fresh(), COMMAND._replace(**{name: value}), Limit.NOT_FINITE)


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_a_measurement_that_is_not_finite_refuses_too(value: float) -> None:
    refused(fresh(), COMMAND, Limit.NOT_FINITE, value, 0.0)
    refused(fresh(), COMMAND, Limit.NOT_FINITE, 0.0, value)


def test_large_numbers_are_finite_though_their_sum_is_not() -> None:
    found = fresh().check(COMMAND._replace(velocity=1.7e308, acceleration=1.7e308), 0.0, 0.0)
    decided(found, Verdict.CLAMPED, Limit.VELOCITY | Limit.ACCELERATION)
    huge = COMMAND._replace(sequence=2**63 - 1, velocity=1.7e308)
    decided(fresh().check(huge, 1.7e308, 0.0), Verdict.CLAMPED, 256 | 16)


def test_what_overflows_is_judged_as_infinite() -> None:
    """Without a warning, as plain Python too."""
    guard, huge = fresh(), 1.7e308
    decided(guard.check(COMMAND._replace(now=-huge, stamp=-huge), 0.0, 0.0), Verdict.PASSED)
    refused(guard, COMMAND._replace(now=huge, stamp=-huge, sequence=2), Limit.STALE)
    late = COMMAND._replace(now=huge, stamp=huge, sequence=2, steering_tire_angle=huge)
    limits = Limit.ANGLE | Limit.RATE | Limit.STEERING_DISTANCE | Limit.LATERAL_ACCELERATION | 32
    decided(guard.check(late, 0.0, -huge), Verdict.CLAMPED, limits)
    back = COMMAND._replace(velocity=-huge, acceleration=1.0)
    found = fresh().check(back, huge, 0.0)
    decided(found, Verdict.CLAMPED, Limit.VELOCITY | Limit.LATERAL_ACCELERATION)
    assert found.acceleration == 0.0


@pytest.mark.parametrize(
    ("age", "stale"),
    [(0.0, False), (0.5, False), (0.5000001, True), (-0.001, False), (-0.0011, True)],
)
def test_freshness(age: float, stale: bool) -> None:
    proposal = COMMAND._replace(now=0.0, stamp=-age)
    if stale:
        refused(fresh(), proposal, Limit.STALE)
    else:
        decided(fresh().check(proposal, 0.0, 0.0), Verdict.PASSED)


def test_the_number_must_rise() -> None:
    guard = fresh()
    guard.check(COMMAND, 0.0, 0.0)
    refused(guard, COMMAND._replace(now=10.1), Limit.SEQUENCE)
    refused(guard, COMMAND._replace(now=10.1, sequence=0), Limit.SEQUENCE)
    decided(guard.check(COMMAND._replace(now=10.1, sequence=2), 0.0, 0.0), Verdict.PASSED)


def test_the_number_must_rise_across_a_silence() -> None:
    guard = fresh()
    guard.check(COMMAND, 0.0, 0.0)
    guard.forget()
    refused(guard, COMMAND._replace(now=20.0), Limit.STALE | Limit.SEQUENCE)
    decided(guard.check(COMMAND._replace(sequence=2), 0.0, 0.0), Verdict.PASSED)


def test_time_must_not_run_backward() -> None:
    guard = fresh()
    guard.check(COMMAND, 0.0, 0.0)
    refused(guard, COMMAND._replace(now=9.9, stamp=9.9, sequence=2), Limit.SEQUENCE)
    decided(guard.check(COMMAND._replace(sequence=2), 0.0, 0.0), Verdict.PASSED)


def test_a_refused_command_leaves_no_trace() -> None:
    stream = Stream(steering_rate=1.0)
    stream.send(0.0)
    bad = Proposal(stream.now + 0.1, 0.0, 99, 0.9, 0.0, 0.0, 0.0)
    refused(stream.guard, bad, Limit.STALE)
    found = decided(stream.send(0.9), Verdict.CLAMPED, Limit.RATE)
    assert found.steering_tire_angle == pytest.approx(0.1)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("limits", "value", "kept", "bit"),
    [
        ({"steering_angle": 0.5}, (0.6, 0.0, 0.0, 0.0), (0.5, 0.0, 0.0, 0.0), Limit.ANGLE),
        ({"rotation_rate": 0.5}, (0.0, 0.6, 0.0, 0.0), (0.0, 0.5, 0.0, 0.0), Limit.ROTATION_RATE),
        ({"velocity": 20.0}, (0.0, 0.0, 21.0, 0.0), (0.0, 0.0, 20.0, 0.0), Limit.VELOCITY),
    ],
)
def test_limits_of_both_sides(
    limits: dict[str, Any], value: Any, kept: Any, bit: Limit, sign: float
) -> None:
    found = Stream(**limits).send(*(sign * v for v in value))
    decided(found, Verdict.CLAMPED, bit)
    assert found[2:] == tuple(sign * v for v in kept)
    at_limit = [sign * v for v in kept]
    decided(Stream(**limits).send(*at_limit), Verdict.PASSED)


@pytest.mark.parametrize("acceleration", [2.0, -4.0])
def test_driving_and_braking_have_limits_of_their_own(acceleration: float) -> None:
    limits = {"acceleration": 2.0, "deceleration": 4.0}
    decided(Stream(**limits).send(acceleration=acceleration), Verdict.PASSED)
    found = Stream(**limits).send(acceleration=acceleration * 1.5)
    assert decided(found, Verdict.CLAMPED, Limit.ACCELERATION).acceleration == acceleration


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_angle_moves_from_command_to_command(sign: float) -> None:
    stream = Stream(steering_rate=1.0)
    decided(stream.send(0.25 * sign), Verdict.PASSED)  # no predecessor
    found = decided(stream.send(0.75 * sign), Verdict.CLAMPED, Limit.RATE)
    assert found.steering_tire_angle == pytest.approx(0.35 * sign)
    stream.guard.forget()
    decided(stream.send(0.9 * sign), Verdict.PASSED)


@pytest.mark.parametrize("judged", [0.3, 0.9])
def test_what_was_not_sent_is_no_predecessor(judged: float) -> None:
    """Neither one that passed nor one that was clamped; what was sent before it is."""
    stream = Stream(steering_rate=1.0)
    stream.send(0.25)
    stream.send(judged, wait=0.05)
    stream.guard.take_back()
    found = decided(stream.send(0.9, wait=0.05), Verdict.CLAMPED, Limit.RATE)
    assert found.steering_tire_angle == pytest.approx(0.35)


def test_to_take_back_the_first_command_leaves_none() -> None:
    stream = Stream(steering_rate=1.0)
    stream.send(0.25)
    stream.guard.take_back()
    decided(stream.send(0.9), Verdict.PASSED)


def test_to_take_back_what_was_refused_changes_nothing() -> None:
    stream = Stream(steering_rate=1.0)
    stream.send(0.1)
    stream.send(0.15)
    refused(stream.guard, COMMAND._replace(now=nan), Limit.NOT_FINITE)
    stream.guard.take_back()
    found = decided(stream.send(0.9), Verdict.CLAMPED, Limit.RATE)
    assert found.steering_tire_angle == pytest.approx(0.25)


def test_the_number_of_what_was_taken_back_stays_used() -> None:
    guard = fresh()
    guard.check(COMMAND, 0.0, 0.0)
    guard.take_back()
    refused(guard, COMMAND, Limit.SEQUENCE)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_distance_from_the_measured_angle(sign: float) -> None:
    stream = Stream(steering_distance=0.3)
    found = stream.send(sign * 0.6, steering=sign * 0.2)
    decided(found, Verdict.CLAMPED, Limit.STEERING_DISTANCE)
    assert found.steering_tire_angle == sign * 0.5
    decided(stream.send(sign * 0.6, steering=sign * 0.2, engaged=False), Verdict.PASSED)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("speed", [10.0, -10.0])
def test_lateral_acceleration(sign: float, speed: float) -> None:
    """3 m/s^2 at 10 m/s is a curvature of 0.03 1/m; with 2.5 m of wheelbase, tan = 0.075."""
    stream = Stream(lateral_acceleration=3.0)
    found = decided(stream.send(sign * 0.1, speed=speed), Verdict.CLAMPED, 16)
    assert found.steering_tire_angle == pytest.approx(sign * atan(0.075))
    decided(stream.send(sign * 0.0748, speed=speed), Verdict.PASSED)
    decided(stream.send(sign * 0.9), Verdict.PASSED)  # at rest


def test_lateral_acceleration_counts_at_walking_speed() -> None:
    """0.1 m/s^2 at 0.5 m/s is a curvature of 0.4 1/m; with 2.5 m of wheelbase, tan = 1."""
    found = Stream(lateral_acceleration=0.1).send(0.9, speed=0.5)
    assert found.steering_tire_angle == pytest.approx(atan(1.0))


def test_a_guard_takes_it_that_the_vehicle_is_engaged() -> None:
    guard = Guard(limited(steering_distance=0.3), WHEEL_BASE, TIMEOUT)
    decided(guard.check(COMMAND, 3.0, 0.5), Verdict.CLAMPED, Limit.STEERING_DISTANCE)


def test_lateral_jerk() -> None:
    """5 m/s^3 for 0.1 s at 10 m/s is 0.005 1/m of curvature; tan rises by 0.0125."""
    stream = Stream(lateral_jerk=5.0)
    stream.send(0.2, speed=10.0)
    up = decided(stream.send(0.3, speed=10.0), Verdict.CLAMPED, Limit.LATERAL_JERK)
    assert tan(up.steering_tire_angle) == pytest.approx(tan(0.2) + 0.0125)
    down = decided(stream.send(0.1, speed=10.0), Verdict.CLAMPED, Limit.LATERAL_JERK)
    assert tan(down.steering_tire_angle) == pytest.approx(tan(0.2))
    decided(stream.send(0.9), Verdict.PASSED)  # at rest


def test_the_acceleration_rises_and_falls_by_its_jerk() -> None:
    stream = Stream(jerk=5.0, brake_jerk=10.0)
    stream.send(acceleration=-2.0)
    rise = decided(stream.send(acceleration=1.0), Verdict.CLAMPED, Limit.JERK)
    assert rise.acceleration == pytest.approx(-1.5)
    fall = decided(stream.send(acceleration=-4.0), Verdict.CLAMPED, Limit.JERK)
    assert fall.acceleration == pytest.approx(-2.5)


@pytest.mark.parametrize(("asked", "sent"), [(0.5, 0.5), (0.0, 0.0), (-1.0, 0.0)])
def test_drive_is_dropped_at_once(asked: float, sent: float) -> None:
    stream = Stream(brake_jerk=10.0)
    stream.send(acceleration=3.0)
    found = decided(stream.send(acceleration=asked), *brake(asked, sent))
    assert found.acceleration == sent


def brake(asked: float, sent: float) -> tuple[Verdict, Limit]:
    same = asked == sent
    return (Verdict.PASSED, Limit(0)) if same else (Verdict.CLAMPED, Limit.JERK)


@pytest.mark.parametrize("speed", [20.1, -20.1])
def test_a_vehicle_that_is_too_fast_is_not_driven_further(speed: float) -> None:
    stream = Stream(velocity=20.0)
    decided(stream.send(acceleration=1.0, speed=copysign(20.0, speed)), Verdict.PASSED)
    found = decided(stream.send(acceleration=1.0, speed=speed), Verdict.CLAMPED, Limit.VELOCITY)
    assert found.acceleration == 0.0
    decided(stream.send(acceleration=-1.0, speed=speed), Verdict.PASSED)


@pytest.mark.parametrize(
    ("wait", "step"),
    [(0.2, 0.2), (0.4, 0.4), (9.0, 0.4), (0.05, 0.1), (0.07, 0.1), (0.02, 0.04), (0.0, 0.0)],
)
def test_the_time_that_a_change_is_measured_against(wait: float, step: float) -> None:
    stream = Stream(steering_rate=1.0)
    stream.send(0.0)
    at_once = Limit.LATERAL_JERK if step == 0.0 else 0
    found = decided(stream.send(0.9, wait=wait), Verdict.CLAMPED, Limit.RATE | at_once)
    assert found.steering_tire_angle == pytest.approx(step, abs=1e-9)


def test_all_limits_hold_at_once_where_that_is_possible() -> None:
    stream = Stream(steering_angle=0.5, steering_rate=1.0, lateral_acceleration=3.0)
    stream.send(0.45)
    found = decided(stream.send(0.9), Verdict.CLAMPED, Limit.ANGLE | Limit.RATE)
    assert found.steering_tire_angle == 0.5


def test_a_wrong_measurement_does_not_make_the_wheel_jump() -> None:
    stream = Stream(steering_rate=1.0, steering_distance=0.3, lateral_acceleration=3.0)
    stream.send(0.4, steering=0.4)
    found = stream.send(0.4, speed=10.0, steering=-0.9)
    decided(found, Verdict.CLAMPED, Limit.STEERING_DISTANCE | Limit.LATERAL_ACCELERATION | 2)
    assert found.steering_tire_angle == pytest.approx(0.3)


def test_the_largest_angle_holds_whatever_the_rate() -> None:
    stream = Stream(steering_rate=1.0, steering_angle=(0.8, 0.2))
    stream.send(0.7)
    found = decided(stream.send(0.7, speed=10.0), Verdict.CLAMPED, Limit.ANGLE)
    assert found.steering_tire_angle == 0.2


def test_the_largest_deceleration_holds_whatever_the_jerk() -> None:
    stream = Stream(brake_jerk=1.0, jerk=1.0, deceleration=(8.0, 4.0))
    stream.send(acceleration=-8.0)
    found = decided(stream.send(acceleration=-8.0, speed=10.0), Verdict.CLAMPED, 64)
    assert found.acceleration == -4.0


@pytest.mark.parametrize(
    ("steering", "kept"), [(0.0, 0.4), (0.5, 0.0), (0.4, 0.1 / 0.6 * 0.8), (0.9, 0.0), (1.0, 0.0)]
)
def test_the_steering_rate_goes_with_the_angle(steering: float, kept: float) -> None:
    """The tyre takes as long for the rest of its way as it would have taken for the whole."""
    found = Stream(steering_angle=0.5).send(1.0, 0.8, steering=steering)
    assert found.steering_tire_rotation_rate == pytest.approx(kept)


def test_the_steering_rate_is_limited_before_it_is_scaled() -> None:
    found = Stream(steering_angle=0.5, rotation_rate=0.4).send(1.0, 0.8)
    decided(found, Verdict.CLAMPED, Limit.ANGLE | Limit.ROTATION_RATE)
    assert found.steering_tire_rotation_rate == 0.2


def test_limits_are_those_of_the_measured_speed() -> None:
    guard = Guard(limited(steering_angle=(1.0, 0.5)), WHEEL_BASE, TIMEOUT)
    proposal = Proposal(1.0, 1.0, 1, 1.0, 0.0, 0.0, 0.0)
    assert guard.check(proposal, -5.0, 0.0).steering_tire_angle == 0.75


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("asked", "sent"), [(1.0, 0.0), (-1.0, -1.0)])
def test_a_vehicle_that_rolls_the_other_way_may_only_slow_down(
    way: float, asked: float, sent: float
) -> None:
    stream = Stream()
    found = stream.send(velocity=-2.0 * way, acceleration=asked, speed=0.51 * way)
    assert found.acceleration == sent
    assert found.limits == (Limit.VELOCITY if asked > 0.0 else 0)


def test_above_which_speed_it_rolls_is_a_limit_too() -> None:
    clamped = Stream(rolling_speed=2.0).send(velocity=-2.0, speed=2.1, acceleration=1.0)
    decided(clamped, Verdict.CLAMPED, Limit.VELOCITY)
    passed = Stream(rolling_speed=2.0).send(velocity=-2.0, speed=2.0, acceleration=1.0)
    decided(passed, Verdict.PASSED, Limit(0))


@pytest.mark.parametrize(("velocity", "speed"), [(-2.0, 0.5), (2.0, 5.0), (-2.0, -5.0), (0.0, 5.0)])
def test_a_vehicle_may_start_the_other_way_and_go_on_in_its_own(
    velocity: float, speed: float
) -> None:
    decision = Stream().send(velocity=velocity, acceleration=1.0, speed=speed)
    assert decision.verdict is Verdict.PASSED and decision.acceleration == 1.0
