# SPDX-License-Identifier: Apache-2.0
"""The declared stop: against sums that were done by hand, then whatever the parameters are."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.kernel.kernel import JIT
from safety_island.life_cycle.params import LifeCycleParams
from safety_island.life_cycle.ramp import Motion
from tests.life_cycle.kernels import StopRamp
from tests.life_cycle.parameters import PARAMETERS

STEADY = replace(
    PARAMETERS,
    stop_deceleration=2.0,
    stop_jerk=4.0,
    stop_hold=0.5,
    stop_steering="hold",
    stop_steering_rate=0.5,
)
DT = 0.25
"""With these every number is exact in binary."""
EXAMPLES = 100 if JIT else 12
"""A ramp may have ten thousand steps, which takes plain Python a while."""


def drive(ramp: StopRamp, dt: float = DT, most: int = 100_000) -> list[Motion]:
    """Every command up to the end of the ramp."""
    motions = []
    while not ramp.is_over:
        motions.append(ramp.step(dt))
        assert len(motions) <= most
    return motions


def test_by_hand() -> None:
    ramp = StopRamp(STEADY, Motion(0.25, 0.1, 9.0, -0.5), 2.0)
    motions = drive(ramp)
    assert [m.acceleration for m in motions] == [-1.5, *[-2.0] * 6]
    assert [m.velocity for m in motions] == [1.625, 1.125, 0.625, 0.125, 0.0, 0.0, 0.0]
    assert all((m.angle, m.rate) == (0.25, 0.0) for m in motions)


def test_the_stopped_vehicle_is_held_for_its_time() -> None:
    ramp = StopRamp(STEADY, Motion(0.0, 0.0, 0.0, 0.0), 0.0)
    ramp.step(DT)
    assert not ramp.is_over  # 0.25 s
    ramp.step(DT)
    assert ramp.is_over  # 0.5 s


def test_without_a_time_to_hold_standstill_is_the_end() -> None:
    ramp = StopRamp(replace(STEADY, stop_hold=0.0), Motion(0.0, 0.0, 0.0, -2.0), 0.5)
    assert ramp.step(DT).velocity == 0.0 and not ramp.is_over
    assert ramp.step(DT).velocity == 0.0 and ramp.is_over


def test_forward_acceleration_is_given_up_at_once() -> None:
    ramp = StopRamp(STEADY, Motion(0.0, 0.0, 9.0, 1.5), 8.0)
    assert ramp.step(DT) == Motion(0.0, 0.0, 7.75, -1.0)


def test_harder_braking_is_let_go_within_the_jerk() -> None:
    ramp = StopRamp(STEADY, Motion(0.0, 0.0, 9.0, -4.5), 8.0)
    assert [ramp.step(DT).acceleration for _ in range(4)] == [-3.5, -2.5, -2.0, -2.0]


@pytest.mark.parametrize(
    ("speed", "commanded", "gear"),
    [(2.0, 2.0, 1), (2.0, -2.0, 1), (-2.0, -2.0, -1), (-2.0, 2.0, -1), (1.0, 0.0, 1)],
)
def test_it_ends_in_the_gear_that_the_vehicle_was_in(
    speed: float, commanded: float, gear: int
) -> None:
    first = StopRamp(STEADY, Motion(0.0, 0.0, commanded, -2.0), speed).step(DT)
    assert first.velocity == gear * (abs(speed) - 0.5)
    assert first.acceleration == -2.0  # along the gear: braking in both


@pytest.mark.parametrize(("commanded", "sign"), [(-1.0, "-"), (1.0, "+"), (0.0, "+")])
def test_at_standstill_the_command_tells_the_gear(commanded: float, sign: str) -> None:
    first = StopRamp(STEADY, Motion(0.0, 0.0, commanded, 0.0), 0.0).step(DT)
    assert f"{first.velocity:+.1f}" == f"{sign}0.0"


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_wheel_is_led_back_within_its_rate(side: float) -> None:
    ramp = StopRamp(replace(STEADY, stop_steering="centre"), Motion(side * 0.3125, 0, 9, 0), 9.0)
    steps = [(side * m.angle, side * m.rate) for m in (ramp.step(DT) for _ in range(5))]
    assert steps == [(0.1875, -0.5), (0.0625, -0.5), (0.0, -0.25), (0.0, 0.0), (0.0, 0.0)]


def some(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False)


parameters = st.builds(
    lambda deceleration, jerk, hold, steering, rate: replace(
        STEADY,
        stop_deceleration=deceleration,
        stop_jerk=jerk,
        stop_hold=hold,
        stop_steering=steering,
        stop_steering_rate=rate,
    ),
    some(0.1, 10.0),
    some(0.1, 50.0),
    some(0.0, 10.0),
    st.sampled_from(["hold", "centre"]),
    some(0.01, 10.0),
)
lasts = st.builds(Motion, some(-0.7, 0.7), some(-1, 1), some(-30, 30), some(-10, 5))


@settings(deadline=None, max_examples=EXAMPLES)
@given(parameters, lasts, some(-30, 30), st.sampled_from([0.01, 0.03, 0.15]))
def test_any_ramp_keeps_its_bounds(
    params: LifeCycleParams, last: Motion, speed: float, dt: float
) -> None:
    motions = drive(StopRamp(params, last, speed), dt)
    before = Motion(last.angle, 0.0, speed, min(last.acceleration, 0.0))
    hardest = max(params.stop_deceleration, -before.acceleration)
    for motion in motions:
        jerk = abs(motion.acceleration - before.acceleration) / dt
        assert jerk <= params.stop_jerk * (1 + 1e-9) + 1e-9
        assert -hardest <= motion.acceleration <= 0.0
        assert abs(motion.velocity) <= abs(before.velocity)
        assert abs(motion.velocity) >= abs(before.velocity) - hardest * dt - 1e-9
        assert motion.velocity * speed >= 0.0
        assert abs(motion.angle - before.angle) <= params.stop_steering_rate * dt + 1e-12
        assert motion.angle == pytest.approx(before.angle + motion.rate * dt, abs=1e-12)
        assert abs(motion.angle) <= abs(before.angle) and motion.angle * last.angle >= 0.0
        if params.stop_steering == "hold":
            assert (motion.angle, motion.rate) == (last.angle, 0.0)
        before = motion
    standing = sum(motion.velocity == 0.0 for motion in motions) - (speed != 0.0)
    assert motions[-1].velocity == 0.0
    assert standing * dt == pytest.approx(max(params.stop_hold, dt), abs=1.001 * dt)


@settings(deadline=None, max_examples=EXAMPLES)
@given(parameters, some(0.1, 30.0))
def test_it_comes_to_rest_in_the_time_that_follows_from_its_limits(
    params: LifeCycleParams, speed: float
) -> None:
    dt = 0.03
    motions = drive(StopRamp(params, Motion(0.0, 0.0, speed, 0.0), speed), dt)
    moving_s = dt * sum(motion.velocity > 0.0 for motion in motions)
    build_up_s = params.stop_deceleration / params.stop_jerk
    assert moving_s <= speed / params.stop_deceleration + build_up_s + dt
