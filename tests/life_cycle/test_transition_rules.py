"""What must hold for every step of the life cycle, stated without the table."""

from __future__ import annotations

from functools import cache

import pytest

from safety_island.life_cycle.reason import EXPLANATIONS, Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Conditions, Life, next_life
from tests.life_cycle.test_transition import PAIRS, conditions

STEPS = [(life, now, next_life(life, now)) for life, now in PAIRS]
BLOCKS = tuple(r for r in Reason if r not in (Reason.NONE, Reason.LATCHED))
START = Life(State.INIT, Reason.WAITING_FOR_INPUT)


@cache
def reachable(has_ramp: bool) -> set[Life]:
    """Every life that can follow a start."""
    found, new = {START}, [START]
    every = [now for now in conditions(BLOCKS) if now.has_ramp is has_ramp]
    while new:
        life = new.pop()
        for then in {next_life(life, now) for now in every} - found:
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
        armed = life.state in (State.ACTIVE, State.HOLD)
        if then.state is State.ACTIVE and now.barred and not armed:
            assert now.arm, (life, now)


def test_no_way_leads_around_the_bar() -> None:
    life = START
    gone = Conditions(Reason.NONE, Reason.MODE_WRITER_GONE, Reason.STALLED, *[False] * 4)
    life = next_life(life, gone)
    assert life == Life(State.READY, Reason.MODE_WRITER_GONE)
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
            assert then.state is (State.SILENT if now.ramp_over else State.STOP)


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
        keeps = life.state in (State.HOLD, State.STOP, State.SILENT)
        assert bool(life.cause) == keeps, life
