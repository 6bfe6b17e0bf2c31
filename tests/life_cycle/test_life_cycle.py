# SPDX-License-Identifier: Apache-2.0
"""From the facts of a tick to a state: what blocks, what latches, what arms."""

from __future__ import annotations

import pytest

from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Life
from tests.life_cycle.rig import GONE, MANUAL, STALE, WELL, Island, silent

RESTARTED = Reason.RESTARTED_WHILE_MOVING


class TestStart:
    def test_it_waits_for_input(self) -> None:
        life_cycle = Island().life_cycle
        assert life_cycle.life == Life(State.INIT, Reason.WAITING_FOR_INPUT)
        assert life_cycle.state is State.INIT and life_cycle.controls

    @pytest.mark.parametrize("speed", [0.0, 0.1249, -0.1249])
    def test_at_standstill_it_arms_itself(self, speed: float) -> None:
        assert Island().tick(speed=speed) == WELL

    @pytest.mark.parametrize("speed", [0.125, -0.125, 3.0, float("nan")])
    def test_while_the_vehicle_moves_it_does_not(self, speed: float) -> None:
        island = Island()
        assert island.tick(speed=speed) == silent(RESTARTED)
        assert island.tick(speed=speed) == silent(RESTARTED)
        assert island.tick(speed=0.0) == silent(Reason.LATCHED, RESTARTED)
        assert not island.life_cycle.controls

    def test_manual_mode_makes_up_for_a_restart(self) -> None:
        island = Island()
        assert island.tick(disengaged=MANUAL) == Life(State.READY, MANUAL)
        assert island.tick() == WELL

    def test_manual_mode_counts_although_an_input_was_lost_since(self) -> None:
        """That the island left READY for a while says nothing of who drove the vehicle."""
        island = Island()
        assert island.tick(disengaged=MANUAL).state is State.READY
        assert island.tick(STALE) == Life(State.INIT, STALE)
        assert island.tick() == WELL

    @pytest.mark.parametrize("mode", [MANUAL, Reason.NONE])
    def test_not_while_another_island_drives(self, mode: Reason) -> None:
        """Who leaves autonomous mode means that one; also when this one was ready before."""
        island, other = Island(), Reason.SECOND_ISLAND
        assert island.tick(disengaged=MANUAL).state is State.READY
        assert island.tick(other, mode) == Life(State.INIT, other)
        assert island.tick(other) == Life(State.INIT, other)
        assert island.tick() == silent(RESTARTED)

    def test_a_mode_that_nobody_tells_does_not(self) -> None:
        island = Island()
        assert island.tick(disengaged=GONE) == Life(State.READY, GONE)
        assert island.tick() == silent(RESTARTED)

    def test_what_was_armed_by_hand_is_not_barred_later(self) -> None:
        island = Island()
        island.tick()
        assert island.tick(arm=True) == WELL
        assert island.tick(disengaged=GONE) == Life(State.READY, GONE, GONE)
        assert island.tick() == WELL


class TestSilence:
    def test_a_cause_is_latched(self) -> None:
        island = Island().engage()
        assert island.tick(STALE) == silent(STALE)
        assert island.tick() == silent(Reason.LATCHED, STALE)
        assert island.tick(arm=True) == WELL

    def test_no_arming_while_a_cause_stands(self) -> None:
        island = Island().engage()
        island.tick(STALE)
        assert island.tick(STALE, arm=True) == silent(STALE)

    def test_what_is_lost_after_the_mode_is_latched(self) -> None:
        island = Island().engage()
        assert island.tick(disengaged=GONE) == Life(State.READY, GONE, GONE)
        assert island.tick(STALE, GONE) == silent(STALE)
        assert island.tick() == silent(Reason.LATCHED, STALE)

    def test_the_states_in_which_the_controllers_count(self) -> None:
        island = Island(has_ramp=True).engage()
        found = {island.life_cycle.state: island.life_cycle.controls}
        for _ in range(60):
            state = island.tick(STALE).state
            island.life_cycle.motion()
            found[state] = island.life_cycle.controls
        island.tick(disengaged=MANUAL)
        found[State.READY] = island.life_cycle.controls
        assert found == {
            State.ACTIVE: True,
            State.HOLD: True,
            State.STOP: False,
            State.SILENT: False,
            State.READY: True,
        }


def test_an_island_may_begin_in_the_silence_of_the_one_before() -> None:
    island = Island()
    island.life_cycle.latch(Reason.PARTITION)
    assert not island.life_cycle.is_armed and not island.life_cycle.controls
    assert island.tick() == silent(Reason.LATCHED, Reason.PARTITION)
