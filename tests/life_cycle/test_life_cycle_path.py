# SPDX-License-Identifier: Apache-2.0
"""A trajectory that cannot be followed: at rest nothing is latched, in motion it is as ever."""

from __future__ import annotations

from typing import Any

import pytest

from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Life
from tests.life_cycle.rig import GONE, STALE, WELL, Island, silent

AT_REST: dict[str, Any] = {"speed": 0.0}
LOST: dict[str, Any] = {"blocked": STALE, "speed": 0.0, "unfollowable": True}


def test_a_trajectory_that_cannot_be_followed_latches_nothing_at_rest() -> None:
    """Whatever the loss of it is called; it goes on by itself when one comes that can be."""
    for blocked in (STALE, Reason.NO_TRAJECTORY):
        island = Island().engage()
        assert island.tick(speed=0.0) == WELL
        for _ in range(3):
            life = island.tick(blocked, speed=-0.09, unfollowable=True)
            assert life == Life(State.INIT, blocked)
        assert island.tick(speed=0.0) == WELL


@pytest.mark.parametrize(
    "lost",
    [
        {"blocked": STALE},
        {"blocked": STALE, "unfollowable": True, "speed": 2.0},
        {"blocked": STALE, "unfollowable": True, "speed": -2.0},
        {"blocked": Reason.PARTITION, "unfollowable": True},
        {"blocked": Reason.COMMAND_REFUSED, "unfollowable": True},
        {"blocked": STALE, "unfollowable": True, "disengaged": GONE},
    ],
    ids=str,
)
def test_any_other_loss_at_rest_is_latched(lost: dict[str, Any]) -> None:
    """A planner that is dead, a vehicle that moves, another input, nobody who says who drives."""
    island = Island().engage()
    assert island.tick(**(AT_REST | lost)).state is State.SILENT
    assert island.tick(speed=0.0) == silent(Reason.LATCHED, lost["blocked"])


def test_an_mpc_that_is_off_its_path_latches_nothing_at_rest() -> None:
    """While one that fails otherwise does."""
    for off_path in (True, False):
        island = Island().engage()
        lives = [island.tick(speed=0.0, unsolved=True, unfollowable=off_path) for _ in range(9)]
        wanted = Life(State.INIT, Reason.MPC_FAILED) if off_path else silent(Reason.MPC_FAILED)
        assert lives[0] == WELL and lives[-1] == wanted


def test_an_island_that_waited_at_rest_does_not_arm_itself_in_motion() -> None:
    island = Island().engage()
    assert island.tick(STALE, speed=0.0, unfollowable=True).state is State.INIT
    barred = Reason.RESTARTED_WHILE_MOVING
    assert island.tick(speed=2.0) == silent(barred)
    assert island.tick(speed=0.0) == silent(Reason.LATCHED, barred)


def test_can_only_holds_a_vehicle_at_rest_and_goes_on_by_itself() -> None:
    """Hold and stop are sent as ever; only their end is another."""
    for comes_back in (False, True):
        island = Island(has_ramp=True, hold_ticks=1).engage()
        island.tick(speed=0.0)
        states: list[State] = []
        while not states or states[-1] in (State.HOLD, State.STOP):
            is_back = comes_back and State.STOP in states
            states.append(island.tick(**(AT_REST if is_back else LOST)).state)
            island.life_cycle.motion()
            assert len(states) < 1000
        assert states[0] is State.HOLD and State.STOP in states
        assert states[-1] is (State.ACTIVE if comes_back else State.INIT)
        assert island.tick(speed=0.0) == WELL


@pytest.mark.parametrize("change", [{"speed": 2.0}, {"unfollowable": False}, {"disengaged": GONE}])
def test_can_only_stays_latched_when_more_was_lost_on_the_way(change: dict[str, Any]) -> None:
    island = Island(has_ramp=True, hold_ticks=1).engage()
    island.tick(speed=0.0)
    for number in range(1000):
        life = island.tick(**(LOST | change if number == 3 else LOST))
        island.life_cycle.motion()
        if life.state not in (State.HOLD, State.STOP):
            break
    assert life == silent(STALE)
    assert island.tick(speed=0.0) == silent(Reason.LATCHED, STALE)


def test_a_stall_on_the_way_is_no_want_of_a_path() -> None:
    island = Island(has_ramp=True).engage()
    island.tick(STALE, speed=0.0, unfollowable=True)
    assert island.begin(after_s=60.0)
    while island.life.state is State.STOP:
        island.tick(speed=0.0)
        island.life_cycle.motion()
    assert island.life == silent(Reason.LATCHED, Reason.STALLED)


def test_a_tick_that_crashed_is_no_want_of_a_path() -> None:
    """At rest as well, and whichever tick it is that crashes."""
    island = Island(fault_ticks=1).engage()
    assert island.tick(speed=0.0) == WELL
    island.begin()
    assert island.life_cycle.fault() == silent(Reason.CONTROLLER_FAULT)
