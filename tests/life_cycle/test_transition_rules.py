# SPDX-License-Identifier: Apache-2.0
"""What must hold for every step of the life cycle, stated without the table."""

from __future__ import annotations

from functools import cache

import pytest

from safety_island.kernel.kernel import JIT
from safety_island.life_cycle.reason import EXPLANATIONS, Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Conditions, Life
from tests.life_cycle.kernels import next_life, successors, table_of
from tests.life_cycle.test_transition import GONE, PAIRS, conditions, is_armed

STEPS = [(life, now, next_life(life, now)) for life, now in PAIRS]
BLOCKS = tuple(r for r in Reason if r not in (Reason.NONE, Reason.LATCHED))[:: 1 if JIT else 5]
"""Every reason that may block; as plain Python some of them, for the pairs are a million."""
START = Life(State.INIT, Reason.WAITING_FOR_INPUT)


@cache
def reachable(has_ramp: bool) -> set[Life]:
    """Every life that can follow a start."""
    found, new = {START}, [START]
    table = table_of([now for now in conditions(BLOCKS) if now.has_ramp is has_ramp])
    while new:
        life = new.pop()
        for then in successors(life, table) - found:
            found.add(then)
            new.append(then)
    return found


def test_silence_stays_while_a_cause_stands() -> None:
    for life, now, then in STEPS:
        if life.state is State.SILENT and now.blocked:
            assert then == Life(State.SILENT, now.blocked, life.cause)


def test_nothing_but_an_explicit_act_ends_silence() -> None:
    for life, now, then in STEPS:
        if life.state is State.SILENT and then.state is not State.SILENT:
            is_taken_over = now.disengaged is Reason.NOT_AUTONOMOUS
            assert is_taken_over or (now.arm and not now.disengaged), (life, now)


def test_silence_keeps_its_cause() -> None:
    for life, _, then in STEPS:
        if life.state is then.state is State.SILENT:
            assert then.cause is life.cause


def test_a_barred_island_does_not_arm_itself() -> None:
    for life, now, then in STEPS:
        armed = is_armed(life) or life.state is State.HOLD
        if then.state is State.ACTIVE and now.barred and not armed:
            assert now.arm, (life, now)


def test_no_way_leads_around_the_bar() -> None:
    life = START
    gone = Conditions(Reason.NONE, GONE, Reason.STALLED, *[False] * 4)
    life = next_life(life, gone)
    assert life == Life(State.READY, GONE)
    life = next_life(life, gone._replace(disengaged=Reason.NONE))
    assert life == Life(State.SILENT, Reason.STALLED, Reason.STALLED)


def test_active_needs_an_engaged_vehicle_and_nothing_in_the_way() -> None:
    for life, now, then in STEPS:
        if then.state is State.ACTIVE:
            assert not now.disengaged and not now.blocked, (life, now)


def test_nothing_blocked_is_sent_by_the_controllers() -> None:
    for _, now, then in STEPS:
        if now.blocked:
            assert then.state not in (State.READY, State.ACTIVE)


def test_hold_and_stop_are_for_vehicles_without_a_gate() -> None:
    states = {life.state for life in reachable(has_ramp=False)}
    assert states == {State.INIT, State.READY, State.ACTIVE, State.SILENT}
    assert {life.state for life in reachable(has_ramp=True)} == set(State)


def test_a_stop_that_has_begun_ends_in_silence_or_with_an_operator() -> None:
    for life, now, then in STEPS:
        if life.state is State.STOP and now.disengaged is not Reason.NOT_AUTONOMOUS:
            if now.only_path and now.ramp_over and not now.disengaged:
                assert not then.cause or now.barred
            else:
                assert then.state is (State.SILENT if now.ramp_over else State.STOP)


def test_a_mode_that_nobody_tells_lets_no_armed_island_off() -> None:
    for life, now, then in STEPS:
        fell = life.state in (State.HOLD, State.STOP, State.SILENT)
        if (fell or is_armed(life)) and now.disengaged is GONE:
            assert then.cause, (life, now)
            assert then.state is not State.INIT


def test_a_vehicle_that_hears_only_can_is_stopped_when_nobody_tells_the_mode() -> None:
    for life, now, then in STEPS:
        if now.has_ramp and now.disengaged is GONE and life.state in (State.ACTIVE, State.HOLD):
            assert then.state is (State.STOP if now.hold_over else State.HOLD)


def test_without_a_vehicle_under_control_nothing_alarms() -> None:
    found = {next_life(START, now) for _, now in PAIRS if now.disengaged}
    assert {life.state for life in found} == {State.INIT, State.READY}


@pytest.mark.parametrize("has_ramp", [False, True])
def test_every_reachable_reason_is_explained(has_ramp: bool) -> None:
    for life in reachable(has_ramp):
        meaning, action = EXPLANATIONS[life.reason]
        assert meaning and action
        assert (life.reason is Reason.NONE) == (life.state is State.ACTIVE), life


@pytest.mark.parametrize("has_ramp", [False, True])
def test_a_cause_is_kept_just_by_what_fell_out_of_active(has_ramp: bool) -> None:
    for life in reachable(has_ramp):
        fell = life.state in (State.HOLD, State.STOP, State.SILENT)
        waits = life.state is State.READY and life.reason is GONE and not has_ramp
        assert bool(life.cause) == fell or waits, life
        assert life.state is not State.READY or life.cause in (Reason.NONE, life.reason)


def test_silence_names_whatever_disengaged_it_since() -> None:
    """With a reason whose number is that of no state, so that the two are not mixed up."""
    now = Conditions(Reason.NONE, Reason.PARTITION, Reason.NONE, *[False] * 4)
    life = Life(State.SILENT, Reason.LATCHED, Reason.STALLED)
    assert next_life(life, now) == Life(State.SILENT, Reason.PARTITION, Reason.STALLED)
