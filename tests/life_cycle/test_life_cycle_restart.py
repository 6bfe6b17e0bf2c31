# SPDX-License-Identifier: Apache-2.0
"""A process that stood still, a machine that slept, ticks that end with an exception."""

from __future__ import annotations

import pytest

from safety_island.life_cycle.ramp import Motion
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Life
from tests.life_cycle.rig import GONE, HELD, MANUAL, STALE, WELL, Island, silent

STALLED = Life(State.INIT, Reason.STALLED)
CRASHED = Reason.CONTROLLER_FAULT


class TestStall:
    @pytest.mark.parametrize(("gap_s", "stalls"), [(0.625, False), (0.6251, True)])
    def test_the_gap_between_two_ticks(self, gap_s: float, stalls: bool) -> None:
        island = Island().engage()
        assert island.begin(gap_s) is stalls
        assert island.life == (STALLED if stalls else WELL)

    @pytest.mark.parametrize(("slept_s", "stalls"), [(0.5, False), (0.5001, True)])
    def test_a_machine_that_slept(self, slept_s: float, stalls: bool) -> None:
        island = Island().engage()
        island.slept_s = slept_s
        assert island.begin() is stalls
        assert not island.begin()  # the same sleep counts once

    def test_sleep_before_the_first_tick_is_of_no_account(self) -> None:
        island = Island()
        island.slept_s = 1e6
        assert not island.begin()
        assert not island.begin()

    def test_a_clock_of_sleep_that_goes_back_hides_no_gap(self) -> None:
        island = Island().engage()
        island.slept_s = -5.0
        assert island.begin(0.75)

    def test_a_moving_vehicle_is_not_driven_on(self) -> None:
        island = Island().engage()
        island.begin(1.0)
        assert island.tick(STALE) == Life(State.INIT, STALE)
        assert island.tick() == silent(Reason.STALLED)
        assert island.tick() == silent(Reason.STALLED)
        assert island.tick(disengaged=MANUAL).state is State.READY
        assert island.tick() == WELL

    def test_what_was_latched_stays_so_even_at_standstill(self) -> None:
        island = Island().engage()
        island.tick(Reason.OVERRUN)
        assert island.begin(1.0)
        assert island.tick(speed=0.0) == silent(Reason.LATCHED, Reason.OVERRUN)

    @pytest.mark.parametrize("ticks", [0, 1, 4], ids=["ACTIVE", "HOLD", "STOP"])
    def test_a_vehicle_that_nobody_else_brakes_is_stopped(self, ticks: int) -> None:
        """From what was sent before, as in any other tick; then silence."""
        island = Island(has_ramp=True).engage()
        for _ in range(ticks):
            island.tick(STALE)
            island.life_cycle.motion()
        assert island.begin(1.0)
        assert island.life == Life(State.STOP, Reason.STALLED, Reason.STALLED)
        motion = island.life_cycle.motion()
        assert motion is not None
        assert motion.acceleration == (-2.0 if ticks == 4 else -1.0)
        for _ in range(60):
            life = island.tick()
            island.life_cycle.motion()
        assert life == silent(Reason.STALLED)

    @pytest.mark.parametrize(("slept_s", "state"), [(0.625, "STOP"), (0.6251, "INIT")])
    def test_after_a_sleep_it_is_not(self, slept_s: float, state: str) -> None:
        island = Island(has_ramp=True).engage()
        island.slept_s = slept_s
        assert island.begin(0.6251)
        assert island.life == Life(State[state], Reason.STALLED, island.life.cause)
        assert (island.life_cycle.motion() is None) is (state == "INIT")

    def test_neither_is_one_that_somebody_else_drives(self) -> None:
        island = Island(has_ramp=True)
        assert island.tick(disengaged=MANUAL).state is State.READY
        assert island.begin(1.0)
        assert island.life == STALLED

    @pytest.mark.parametrize("fact", ["failed", "refused", "unsolved", "sent"])
    def test_what_went_wrong_before_is_forgotten(self, fact: str) -> None:
        island = Island().engage()
        island.went_out = fact != "sent"
        refused = Reason.COMMAND_STALE if fact == "refused" else Reason.NONE

        def tick(speed: float) -> Life:
            failed, unsolved = fact == "failed", fact == "unsolved"
            return island.tick(speed=speed, refused=refused, failed=failed, unsolved=unsolved)

        for _ in range(2 + (fact == "sent")):
            assert tick(2.0) == WELL
        island.begin(2.0)
        island.went_out = True
        assert tick(0.0) == WELL

    def test_late_ticks_before_it_are_forgotten(self) -> None:
        island = Island().engage()
        for _ in range(5):
            island.tick(skipped=1)
        island.begin(2.0)
        assert island.tick(speed=0.0, skipped=1) == WELL


class TestCrash:
    def crash(self, island: Island) -> Life:
        island.begin()
        assert island.life_cycle.fault() is island.life
        return island.life

    def test_three_ticks_in_a_row_that_end_with_an_exception(self) -> None:
        island = Island().engage()
        assert [self.crash(island) for _ in range(2)] == [WELL] * 2
        assert self.crash(island) == silent(CRASHED)
        assert self.crash(island) == silent(CRASHED)
        assert island.tick() == silent(CRASHED)  # it stands until a whole tick went well
        assert island.tick() == silent(Reason.LATCHED, CRASHED)

    def test_one_tick_that_does_not_forgives(self) -> None:
        island = Island().engage()
        for _ in range(3):
            self.crash(island)
            self.crash(island)
            assert island.tick() == WELL

    def test_a_silence_keeps_its_cause(self) -> None:
        island = Island().engage()
        island.tick(STALE)
        found = [self.crash(island) for _ in range(4)]
        assert found == [silent(STALE)] * 2 + [silent(CRASHED, STALE)] * 2

    def test_it_is_armed_while_nobody_tells_the_mode(self) -> None:
        island = Island(fault_ticks=1).engage()
        island.tick(disengaged=GONE)
        assert self.crash(island) == silent(CRASHED)

    def test_before_it_is_armed_nothing_is_latched(self) -> None:
        island = Island()
        island.tick(disengaged=MANUAL)
        for _ in range(3):
            life = self.crash(island)
        assert life == Life(State.INIT, CRASHED)
        assert island.tick(disengaged=MANUAL) == Life(State.INIT, CRASHED)
        assert island.tick(disengaged=MANUAL) == Life(State.READY, MANUAL)

    def test_with_can_alone_it_stops_the_vehicle_from_where_it_was(self) -> None:
        island = Island(has_ramp=True).engage()
        for speed in (2.0, 3.0):
            island.tick(speed=speed)
        found = []
        for _ in range(5):
            self.crash(island)
            found.append((island.life.state.name, island.life_cycle.motion()))
        assert found == [
            *[("ACTIVE", None)] * 2,
            *[("HOLD", HELD)] * 2,
            ("STOP", Motion(0.25, 0.0, 2.875, -1.0)),
        ]

    @pytest.mark.parametrize("ticks", [1, 4])
    def test_one_is_enough_to_go_on_with_a_stop(self, ticks: int) -> None:
        island = Island(has_ramp=True).engage()
        for _ in range(ticks):
            island.tick(STALE)
            island.life_cycle.motion()
        state = island.life.state
        assert state is (State.HOLD if ticks == 1 else State.STOP)
        assert self.crash(island) == Life(state, CRASHED, STALE)
        for _ in range(40):
            assert island.life_cycle.motion() is not None or island.life.state is State.SILENT
            self.crash(island)
        assert island.life == silent(CRASHED, STALE)
