# SPDX-License-Identifier: Apache-2.0
"""What goes wrong in the island itself, and from when on it ends the output."""

from __future__ import annotations

from safety_island.life_cycle.facts import Facts
from safety_island.life_cycle.overrun import Overrun
from safety_island.life_cycle.params import LifeCycleParams
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.streak import Streak


class Failures:
    """Counts failures of ticks, controllers, guard and outputs in a row; times in s, monotonic."""

    def __init__(self, params: LifeCycleParams, overrun: Overrun) -> None:
        self._params, self._overrun = params, overrun
        self._faults, self._refusals, self._outputs = Streak(), Streak(), Streak()
        self._unsolved = Streak()
        self._crashes, self._has_crashed = 0, False

    def begin(self) -> None:
        """Begin a tick: the one before has ended, in whatever way."""
        if not self._has_crashed:
            self._crashes = 0
        self._has_crashed = False

    def crash(self) -> bool:
        """Note that the tick ended with an exception; True when too many did."""
        self._has_crashed = True
        self._crashes += 1
        return self._crashes >= self._params.fault_ticks

    def sent(self, went_out: bool, now: float) -> None:
        """Note whether an output took the command."""
        self._outputs.note(not went_out, now)

    def are_none(self, facts: Facts) -> bool:
        """Whether nothing went wrong in this tick, and nothing is still counted from before."""
        wrong = facts.failed or facts.unsolved or facts.refused or self._overrun.over
        controls = self._faults.count or self._unsolved.count or self._refusals.count
        return not (wrong or controls or self._outputs.count or self._crashes)

    def judge(self, facts: Facts, now: float) -> Reason:
        """Count what went wrong in this tick; return what that forbids, NONE when nothing."""
        self._faults.note(facts.failed, now)
        self._unsolved.note(facts.unsolved, now)
        self._refusals.note(facts.refused is not Reason.NONE, now)
        params = self._params
        if self._overrun.over:
            return Reason.OVERRUN
        if max(self._faults.count, self._crashes) >= params.fault_ticks:
            return Reason.CONTROLLER_FAULT
        if 0.0 < params.mpc_failure_time < self._unsolved.lasts_s(now):
            return Reason.MPC_FAILED
        if self._refusals.count >= params.fault_ticks:
            return facts.refused
        return Reason.OUTPUT_FAILED if self._outputs.count >= params.fault_ticks else Reason.NONE

    def forget(self) -> None:
        """Begin anew; how the last tick ended is of now."""
        self._overrun.forget()
        for streak in (self._faults, self._refusals, self._outputs, self._unsolved):
            streak.forget()

    def forget_outputs(self) -> None:
        """Nothing is sent: what is not tried cannot fail."""
        self._outputs.forget()
