"""The life cycle at work: what a tick found out becomes conditions, and those a state."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.life_cycle.overrun import Overrun
from safety_island.life_cycle.params import LifeCycleParams
from safety_island.life_cycle.ramp import Motion, StopRamp
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.streak import Streak
from safety_island.life_cycle.transition import Conditions, Life, next_life


class Facts(NamedTuple):
    """What a tick found out; speed in m/s."""

    blocked: Reason
    """What the inputs and the other publishers forbid, NONE when nothing."""
    disengaged: Reason
    """Why the vehicle is not under control, NONE when it is."""
    speed: float
    arm: bool = False
    """Somebody asked to arm the island."""
    failed: bool = False
    """The controllers ended with an exception."""
    unsolved: bool = False
    """The MPC found no steering angle."""
    refused: Reason = Reason.NONE
    """Why the command must not go out."""


_QUIET = (Reason.NONE, Reason.NONE)
_CONTROLS = frozenset({State.INIT, State.READY, State.ACTIVE, State.HOLD})


class LifeCycle:
    """State, reason and memory of the island; told the time [s, monotonic], reads no clock.

    ``life`` is state, reason and latched cause. ``has_ramp``: the vehicle hears only CAN, and
    nobody brakes it when commands stop.
    """

    def __init__(self, params: LifeCycleParams, period_s: float, has_ramp: bool = False) -> None:
        self.life = Life(State.INIT, Reason.WAITING_FOR_INPUT)
        self.overrun = Overrun(params, period_s)
        self._params, self._period_s, self._has_ramp = params, period_s, has_ramp
        self._barred = Reason.RESTARTED_WHILE_MOVING
        self._faults, self._refusals, self._outputs = Streak(), Streak(), Streak()
        self._unsolved, self._crashes = Streak(), Streak()
        self._has_crashed = False
        self._last_tick: float | None = None
        self._last_sleep_s = 0.0
        self._speed = 0.0
        self._last_sent = Motion(0.0, 0.0, 0.0, 0.0)
        self._holds = 0
        self._ramp: StopRamp | None = None

    @property
    def state(self) -> State:
        """The present state."""
        return self.life.state

    @property
    def controls(self) -> bool:
        """Whether the controllers may count on being followed."""
        return self.life.state in _CONTROLS

    def begin(self, now: float, slept_s: float, skipped: int) -> bool:
        """Begin a tick; True when the process stood still, and everything begins anew.

        ``slept_s`` [s] is how long the machine has slept in all, ``skipped`` counts missed ticks.
        """
        self._crashes.note(self._has_crashed, now)
        self._has_crashed = False
        last, self._last_tick = self._last_tick, now
        slept, self._last_sleep_s = slept_s - self._last_sleep_s, slept_s
        gap_s = 0.0 if last is None else now - last + max(slept, 0.0)
        if gap_s > self._params.stall_limit + self._period_s:
            self._restart()
            return True
        self.overrun.tick(now, skipped)
        return False

    def _restart(self) -> None:
        if self.life.state is not State.SILENT:  # what is latched stays so
            self.life = Life(State.INIT, Reason.STALLED)
        self._barred = Reason.STALLED
        self.overrun.forget()
        for streak in (self._faults, self._refusals, self._outputs, self._unsolved):
            streak.note(False, 0.0)

    def judge(self, facts: Facts, now: float) -> Life:
        """Take the facts of a tick; return the state that decides what it sends."""
        self._speed = facts.speed
        if self.life.state is State.ACTIVE and facts[:2] == _QUIET and self._is_calm(facts):
            return self.life  # the usual case, in which nothing can change
        self._faults.note(facts.failed, now)
        self._unsolved.note(facts.unsolved, now)
        self._refusals.note(facts.refused is not Reason.NONE, now)
        if facts.disengaged is Reason.NOT_AUTONOMOUS:
            self._barred = Reason.NONE
        return self._step(facts.blocked or self._own_cause(facts, now), facts.disengaged, facts.arm)

    def _step(self, blocked: Reason, disengaged: Reason = Reason.NONE, arm: bool = False) -> Life:
        before = self.life.state
        is_moving = not abs(self._speed) < self._params.moving_speed
        self.life = next_life(
            self.life,
            Conditions(
                blocked=blocked,
                disengaged=disengaged,
                barred=self._barred if is_moving else Reason.NONE,
                arm=arm,
                has_ramp=self._has_ramp,
                hold_over=self._holds >= self._params.hold_ticks,
                ramp_over=self._ramp is not None and self._ramp.is_over,
            ),
        )
        if self.life.state is State.ACTIVE:
            self._barred = Reason.NONE
        self._enter(before)
        return self.life

    def _is_calm(self, facts: Facts) -> bool:
        """Whether nothing went wrong in this tick, and nothing is still counted from before."""
        wrong = facts.failed or facts.unsolved or facts.refused or self.overrun.over
        counts = (self._faults, self._unsolved, self._refusals, self._outputs, self._crashes)
        return not wrong and not any([streak.count for streak in counts])

    def fault(self) -> Life:
        """Note a tick that ended with an exception; too many end the output as other causes do.

        A stop that has begun goes on. Nobody has heard who drives, which lets nobody off.
        """
        self._has_crashed = True
        are_many = self._crashes.count + 1 >= self._params.fault_ticks
        if are_many or self.life.state in (State.HOLD, State.STOP):
            return self._step(Reason.CONTROLLER_FAULT)
        return self.life

    def _own_cause(self, facts: Facts, now: float) -> Reason:
        """What ticks, controllers, guard and outputs forbid."""
        params = self._params
        if self.overrun.over:
            return Reason.OVERRUN
        if max(self._faults.count, self._crashes.count) >= params.fault_ticks:
            return Reason.CONTROLLER_FAULT
        if 0.0 < params.mpc_failure_time < self._unsolved.lasts_s(now):
            return Reason.MPC_FAILED
        if self._refusals.count >= params.fault_ticks:
            return facts.refused
        return Reason.OUTPUT_FAILED if self._outputs.count >= params.fault_ticks else Reason.NONE

    def _enter(self, before: State) -> None:
        state = self.life.state
        if state is State.STOP and before is not State.STOP:
            self._ramp = StopRamp(self._params, self._last_sent, self._speed)
        elif state not in (State.HOLD, State.STOP):
            self._holds, self._ramp = 0, None
        if state in (State.INIT, State.SILENT):
            self._outputs.note(False, 0.0)  # what is not tried cannot fail

    def motion(self) -> Motion | None:
        """Return the command that HOLD and STOP send in place of the controllers'."""
        if self.life.state is State.HOLD:
            self._holds += 1
            return self._last_sent._replace(rate=0.0)
        return None if self._ramp is None else self._ramp.step(self._period_s)

    def sent(self, motion: Motion, went_out: bool, now: float) -> None:
        """Note a command of the controllers that went out, or that no output could take."""
        self._outputs.note(not went_out, now)
        if went_out:
            self._last_sent = motion
