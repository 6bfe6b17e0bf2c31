# SPDX-License-Identifier: Apache-2.0
"""Whatever goes in, what comes out keeps every limit, or nothing comes out."""

from __future__ import annotations

from math import isnan, tan

from hypothesis import given
from hypothesis import strategies as st

from safety_island.core.guard import Decision, Guard, Proposal
from safety_island.guard import Limit, Verdict
from safety_island.guard.limit import REFUSALS
from safety_island.params import load_set

PARAMETERS = load_set("default")
LIMITS = PARAMETERS.guard
FLAT = (  # at walking speed: the same for every speed that is drawn
    LIMITS.steering_angle[1],
    LIMITS.rotation_rate[1],
    LIMITS.acceleration[1],
    LIMITS.deceleration[1],
)
WHEEL_BASE, TIMEOUT, SLACK = PARAMETERS.vehicle.wheel_base, 0.5, 1e-9

anything = st.floats()
hostile = st.one_of(anything, st.floats(-10.0, 10.0), st.sampled_from([0.0, 0.7, -0.7, 5.0]))
commands = st.tuples(
    st.floats(0.0, 1.0),
    st.floats(-0.1, 0.6),
    st.integers(-1, 3),
    hostile,
    hostile,
    hostile,
    hostile,
)
slow = st.floats(-0.5, 0.5)


def keeps(found: Decision, speed: float) -> None:
    angle, rotation, drive, brake = FLAT
    assert abs(found.steering_tire_angle) <= angle
    assert abs(found.steering_tire_rotation_rate) <= rotation
    assert abs(found.velocity) <= LIMITS.velocity
    assert -brake <= found.acceleration <= drive
    lateral = speed * speed * tan(found.steering_tire_angle) / WHEEL_BASE
    assert abs(lateral) <= LIMITS.lateral_acceleration[0] * (1.0 + SLACK)


def follows(found: Decision, before: Decision, gap: float) -> None:
    """Hold the limits of change, for the longest time that a gap may count as."""
    step = min(2.0 * gap if gap < LIMITS.shortest_step else gap, LIMITS.longest_step)
    moved = found.steering_tire_angle - before.steering_tire_angle
    assert abs(moved) <= LIMITS.steering_rate[0] * step + SLACK
    pushed = found.acceleration - before.acceleration
    assert pushed <= LIMITS.jerk[0] * step + SLACK
    if found.acceleration < 0.0:
        assert min(before.acceleration, 0.0) - found.acceleration <= (
            LIMITS.brake_jerk[0] * step + SLACK
        )


@given(st.lists(st.tuples(commands, slow, st.one_of(slow, anything)), max_size=12))
def test_hostile_commands(stream: list[tuple[tuple[float, ...], float, float]]) -> None:
    guard = Guard(LIMITS, WHEEL_BASE, TIMEOUT)
    now, sequence, before, sent_at = 0.0, 0, None, 0.0
    for (wait, age, rise, *values), speed, steering in stream:
        now, sequence = now + wait, sequence + int(rise)
        angle, rotation, velocity, push = values
        proposal = Proposal(now, now - age, sequence, angle, rotation, velocity, push)
        found = guard.check(proposal, speed, steering)
        told_honestly(proposal, found)
        if found.verdict is not Verdict.REFUSED:
            keeps(found, speed)
            if before is not None:
                follows(found, before, now - sent_at)
            before, sent_at = found, now


def told_honestly(proposal: Proposal, found: Decision) -> None:
    """Nothing changes silently, braking stays braking, and what is refused has no values."""
    if found.verdict is Verdict.REFUSED:
        assert found.limits and not found.limits & ~REFUSALS
        assert all(map(isnan, found[2:]))
        return
    assert not found.limits & REFUSALS
    assert bool(found.limits) == (found.verdict is Verdict.CLAMPED)
    if found.verdict is Verdict.PASSED:
        assert list(map(float.hex, found[2:])) == list(map(float.hex, proposal[3:]))
    if proposal.acceleration <= 0.0:
        assert found.acceleration <= 0.0
    assert found.velocity * proposal.velocity >= 0.0
    assert found.steering_tire_rotation_rate * proposal.steering_tire_rotation_rate >= 0.0


# A measured angle beyond the largest one would leave no angle that is near it and allowed.
@given(st.floats(-30.0, 30.0), st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(-0.7, 0.7))
def test_what_was_let_through_passes_again(
    speed: float, angle: float, push: float, steering: float
) -> None:
    def check(values: tuple[float, ...]) -> Decision:
        angle, rotation, velocity, push = values
        proposal = Proposal(1.0, 1.0, 1, angle, rotation, velocity, push)
        return Guard(LIMITS, WHEEL_BASE, TIMEOUT).check(proposal, speed, steering)

    first = check((angle, 0.1, 5.0, push))
    if not first.limits & (Limit.STEERING_DISTANCE | Limit.LATERAL_ACCELERATION):
        assert check(first[2:]).verdict is Verdict.PASSED
