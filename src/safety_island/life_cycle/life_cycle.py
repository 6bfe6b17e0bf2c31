# SPDX-License-Identifier: Apache-2.0
"""The life cycle at work: what a tick found out becomes conditions, and those a state."""

from __future__ import annotations

from safety_island.life_cycle.facts import Facts
from safety_island.life_cycle.failures import Failures
from safety_island.life_cycle.overrun import Overrun
from safety_island.life_cycle.params import LifeCycleParams
from safety_island.life_cycle.ramp import Motion
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.stop import Stop
from safety_island.life_cycle.transition import Conditions, Life, next_life

_QUIET = (Reason.NONE, Reason.NONE)
_ACTIVE = State.ACTIVE
_DRIVES = (_ACTIVE, State.HOLD, State.STOP)
_CONTROLS = (_ACTIVE, State.READY, State.INIT, State.HOLD)
_STOPS = (State.HOLD, State.STOP)
_OF_THE_PATH = (Reason.NO_TRAJECTORY, Reason.INPUT_STALE, Reason.MPC_FAILED)
"""What a trajectory that cannot be followed may end in."""


class LifeCycle:
    """State, reason and memory of the island; told the time [s, monotonic], reads no clock.

    ``life`` is state, reason and latched cause. ``has_ramp``: the vehicle hears only CAN, and
    nobody brakes it when commands stop.
    """

    def __init__(self, params: LifeCycleParams, period_s: float, has_ramp: bool) -> None:
        self.life = Life(State.INIT, Reason.WAITING_FOR_INPUT)
        self.overrun = Overrun(params, period_s)
        self._failures, self._stop = Failures(params, self.overrun), Stop(params, period_s)
        self._moving_speed, self._has_ramp = params.moving_speed, has_ramp
        self._period_s = self._step_s = period_s
        self._longest_gap_s = params.stall_limit + period_s
        self._barred = Reason.RESTARTED_WHILE_MOVING
        self._last_tick: float | None = None
        self._last_sleep_s = self._speed = 0.0
        self._only_path = False
        """Since ACTIVE was left, nothing was lost but a trajectory, and the vehicle stood."""

    @property
    def state(self) -> State:
        """The present state."""
        return self.life.state

    @property
    def controls(self) -> bool:
        """Whether the controllers may count on being followed."""
        return self.life.state in _CONTROLS

    @property
    def is_armed(self) -> bool:
        """Whether the vehicle is under control, or may be again without being engaged anew."""
        state, _, cause = self.life
        return state in _DRIVES or (state is State.READY and cause is not Reason.NONE)

    @property
    def must_stop(self) -> bool:
        """Whether commands may not just end: the vehicle hears only CAN, and is not at rest.

        A stop that has begun is carried through. It always comes to its end, since it follows the
        time and no measurement.
        """
        if self.life.state in (State.HOLD, State.STOP):
            return True
        if not self._has_ramp or self.life.state is not _ACTIVE:
            return False
        last, slow = self._stop.last_sent, self._moving_speed
        is_at_rest = abs(self._speed) < slow and abs(last.velocity) < slow
        return not (is_at_rest and last.acceleration <= 0.0)

    def latch(self, cause: Reason) -> None:
        """Begin in silence, as the process did that this one takes the place of."""
        self.life = Life(State.SILENT, cause, cause)

    def begin(self, now: float, slept_s: float, skipped: int) -> bool:
        """Begin a tick; True when the process stood still, and everything begins anew.

        ``slept_s`` [s] is how long the machine has slept in all, ``skipped`` counts missed ticks.
        """
        self._failures.begin()
        last, self._last_tick = self._last_tick, now
        slept, self._last_sleep_s = slept_s - self._last_sleep_s, slept_s
        gap_s = 0.0 if last is None else now - last + max(slept, 0.0)
        self._step_s = self._period_s if last is None else now - last
        if gap_s > self._longest_gap_s:
            self._restart(slept > self._longest_gap_s)
            return True
        self.overrun.tick(now, skipped)
        return False

    def _restart(self, has_slept: bool) -> None:
        """Begin anew; a vehicle that nobody else brakes is stopped first, if it was not asleep."""
        self._step_s = self._period_s
        if self._has_ramp and not has_slept and self.life.state in _DRIVES:
            self.life = Life(State.STOP, Reason.STALLED, Reason.STALLED)
            self._stop.enter(State.STOP, self._speed)
        elif self.life.state is not State.SILENT:  # what is latched stays so
            self.life = Life(State.INIT, Reason.STALLED)
        self._barred, self._only_path = Reason.STALLED, False
        self._failures.forget()

    def judge(self, facts: Facts, now: float) -> Life:
        """Take the facts of a tick; return the state that decides what it sends."""
        self._speed = facts.speed
        is_active = self.life.state is _ACTIVE
        if is_active and facts[:2] == _QUIET and self._failures.are_none(facts):
            return self.life  # the usual case, in which nothing can change
        if facts.blocked is Reason.SECOND_ISLAND:  # who leaves autonomous mode means the other one
            self._barred = Reason.RESTARTED_WHILE_MOVING
        elif facts.disengaged is Reason.NOT_AUTONOMOUS:
            self._barred = Reason.NONE
        own = self._failures.judge(facts, now)
        blocked = facts.blocked or own
        is_of_path = not blocked or (facts.unfollowable and blocked in _OF_THE_PATH)
        return self._step(blocked, facts.disengaged, facts.arm, is_of_path)

    def fault(self) -> Life:
        """Note a tick that ended with an exception; too many end the output as other causes do.

        A stop that has begun goes on. Nobody has heard who drives, which lets nobody off.
        """
        if self._failures.crash() or self.life.state in (State.HOLD, State.STOP):
            return self._step(Reason.CONTROLLER_FAULT)
        return self.life

    def _step(
        self,
        blocked: Reason,
        disengaged: Reason = Reason.NONE,
        arm: bool = False,
        is_of_path: bool = False,
    ) -> Life:
        is_moving = not abs(self._speed) < self._moving_speed
        barred = self._barred if is_moving else Reason.NONE
        before, stop = self.life.state, (self._stop.hold_over, self._stop.ramp_over)
        may_wait = is_of_path and not is_moving and not disengaged
        self._only_path = only_path = may_wait and (self._only_path or before not in _STOPS)
        now = Conditions(blocked, disengaged, barred, arm, self._has_ramp, *stop, only_path)
        self.life = next_life(self.life, now)
        state = self.life.state
        if only_path and before is not State.INIT and state is State.INIT:
            self._barred = Reason.RESTARTED_WHILE_MOVING  # it goes on by itself only where it stood
        if state in (State.INIT, State.SILENT):
            self._failures.forget_outputs()
        self._stop.enter(state, self._speed)
        return self.life

    def motion(self) -> Motion | None:
        """Return the command that HOLD and STOP send in place of the controllers'."""
        return self._stop.motion(self.life.state, max(self._step_s, 0.5 * self._period_s))

    def sent(self, motion: Motion, went_out: bool, now: float) -> None:
        """Note a command of the controllers that went out, or that no output could take."""
        self._failures.sent(went_out, now)
        if went_out:
            self._stop.last_sent = motion
