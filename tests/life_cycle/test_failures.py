# SPDX-License-Identifier: Apache-2.0
"""What goes wrong in the island itself: how much of it ends the output, and what is named first."""

from __future__ import annotations

import pytest

from safety_island.life_cycle.reason import Reason
from tests.life_cycle.rig import MANUAL, STALE, WELL, Island, silent


class TestCauses:
    def test_ticks_that_come_too_late(self) -> None:
        island = Island().engage()
        assert [island.tick(skipped=1) for _ in range(5)] == [WELL] * 5
        assert island.tick(skipped=1) == silent(Reason.OVERRUN)
        assert island.tick() == silent(Reason.LATCHED, Reason.OVERRUN)

    def test_what_is_known_of_late_ticks(self) -> None:
        island = Island().engage()
        overrun = island.life_cycle.overrun
        found = []
        for skipped in (0, 1, 1, 1, 1, 1, 1, 0):
            island.tick(skipped=skipped)
            found.append((overrun.in_row, overrun.degraded, overrun.over))
            assert [type(value) for value in found[-1]] == [int, bool, bool]
        late = [(i, i >= 3, i >= 6) for i in range(7)]
        assert found == [*late, (0, False, False)]

    def test_no_tick_failed_before_the_first(self) -> None:
        assert Island(fault_ticks=1).tick(speed=0.0) == WELL

    def test_controllers_that_fail(self) -> None:
        island = Island().engage()
        assert [island.tick(failed=True) for _ in range(2)] == [WELL] * 2
        assert island.tick() == WELL
        assert [island.tick(failed=True) for _ in range(2)] == [WELL] * 2
        assert island.tick(failed=True) == silent(Reason.CONTROLLER_FAULT)
        assert island.tick(failed=True, arm=True) == silent(Reason.CONTROLLER_FAULT)
        assert island.tick(arm=True) == WELL

    def test_faults_and_ticks_that_crashed_are_not_added_up(self) -> None:
        island = Island().engage()
        assert island.tick(failed=True) == WELL
        for _ in range(2):
            island.begin()
            assert island.life_cycle.fault() == WELL
        assert island.tick(failed=True) == WELL

    @pytest.mark.parametrize("reason", [Reason.COMMAND_STALE, Reason.COMMAND_REFUSED])
    def test_commands_that_are_refused(self, reason: Reason) -> None:
        island = Island().engage()
        assert [island.tick(refused=reason) for _ in range(2)] == [WELL] * 2
        assert island.tick() == WELL
        assert [island.tick(refused=reason) for _ in range(2)] == [WELL] * 2
        assert island.tick(refused=reason) == silent(reason)

    def test_an_mpc_without_a_solution_for_longer_than_its_time(self) -> None:
        island = Island().engage()
        assert [island.tick(unsolved=True) for _ in range(5)] == [WELL] * 5  # 0.5 s
        assert island.tick(unsolved=True) == silent(Reason.MPC_FAILED)

    def test_one_solution_is_enough(self) -> None:
        island = Island().engage()
        for unsolved in [True] * 5 + [False] + [True] * 5:
            assert island.tick(unsolved=unsolved) == WELL

    def test_an_mpc_that_may_fail_for_ever(self) -> None:
        island = Island(mpc_failure_time=0.0).engage()
        assert [island.tick(unsolved=True) for _ in range(20)] == [WELL] * 20

    def test_what_the_inputs_forbid_is_named_first(self) -> None:
        island = Island(fault_ticks=1).engage()
        assert island.tick(STALE, failed=True) == silent(STALE)
        assert island.tick(failed=True).reason is Reason.CONTROLLER_FAULT

    def test_the_order_of_the_others(self) -> None:
        island = Island(fault_ticks=1, overrun_ticks=1, mpc_failure_time=0.0625).engage()
        island.tick(skipped=1, unsolved=True)
        refused = Reason.COMMAND_STALE
        found = [
            island.tick(skipped=1, failed=True, unsolved=True, refused=refused),
            island.tick(failed=True, unsolved=True, refused=refused),
            island.tick(unsolved=True, refused=refused),
            island.tick(refused=refused),
        ]
        names = ["OVERRUN", "CONTROLLER_FAULT", "MPC_FAILED", "COMMAND_STALE"]
        assert [life.reason.name for life in found] == names


class TestOutputs:
    def test_outputs_that_take_nothing(self) -> None:
        island = Island().engage()
        island.went_out = False
        assert [island.tick() for _ in range(3)] == [WELL] * 3
        assert island.tick() == silent(Reason.OUTPUT_FAILED)

    def test_one_that_went_out_ends_the_count(self) -> None:
        island = Island().engage()
        for went_out in (False, False, True, False, False, True):
            island.went_out = went_out
            assert island.tick() == WELL
        assert island.tick() == WELL

    def test_in_silence_nothing_is_tried_and_nothing_fails(self) -> None:
        island = Island().engage()
        island.went_out = False
        for _ in range(4):
            island.tick()
        assert island.tick() == silent(Reason.LATCHED, Reason.OUTPUT_FAILED)
        island.went_out = True
        assert island.tick(arm=True) == WELL

    def test_before_it_is_armed_it_tries_again(self) -> None:
        island = Island()
        island.went_out = False
        states = [island.tick(disengaged=MANUAL).state.name for _ in range(8)]
        assert states == ["READY", "READY", "READY", "INIT"] * 2
