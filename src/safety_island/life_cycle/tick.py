# SPDX-License-Identifier: Apache-2.0
"""The life cycle at work: what a tick found out becomes conditions, and those a state.

``p`` is LIFE_PARAMS, ``s`` LIFE_STATE; times in s, monotonic. No kernel reads a clock.
"""

from safety_island.kernel.kernel import entry, kernel
from safety_island.life_cycle.failures import (
    begin_tick,
    failure,
    forget_failures,
    note,
    note_crash,
    note_facts,
)
from safety_island.life_cycle.overrun import note_tick
from safety_island.life_cycle.ramp import copy_motion, enter, hold_over, is_stopping, next_motion
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.records import FACTS, LIFE_PARAMS, LIFE_STATE, MOTION
from safety_island.life_cycle.state import LifeFlag, State
from safety_island.life_cycle.transition import Conditions, Life, next_life

INIT = int(State.INIT)
READY = int(State.READY)
ACTIVE = int(State.ACTIVE)
HOLD = int(State.HOLD)
STOP = int(State.STOP)
SILENT = int(State.SILENT)
NONE = int(Reason.NONE)
WAITING_FOR_INPUT = int(Reason.WAITING_FOR_INPUT)
NO_TRAJECTORY = int(Reason.NO_TRAJECTORY)
NOT_AUTONOMOUS = int(Reason.NOT_AUTONOMOUS)
INPUT_STALE = int(Reason.INPUT_STALE)
SECOND_ISLAND = int(Reason.SECOND_ISLAND)
RESTARTED_WHILE_MOVING = int(Reason.RESTARTED_WHILE_MOVING)
STALLED = int(Reason.STALLED)
CONTROLLER_FAULT = int(Reason.CONTROLLER_FAULT)
MPC_FAILED = int(Reason.MPC_FAILED)
CONTROLS = int(LifeFlag.CONTROLS)
ARMED = int(LifeFlag.ARMED)
MUST_STOP = int(LifeFlag.MUST_STOP)


@kernel
def start(p, s):
    """Set the start values of memory that is all zero."""
    set_life(s, Life(INIT, WAITING_FOR_INPUT, NONE))
    s.barred = RESTARTED_WHILE_MOVING
    s.step_s = p.period_s


@kernel
def set_life(s, life):
    """Store a Life."""
    s.life.state = life.state
    s.life.reason = life.reason
    s.life.cause = life.cause


@kernel
def begin(p, s, now, slept_s, skipped):
    """Begin a tick; True when the process stood still, and everything begins anew.

    ``slept_s`` [s] is how long the machine has slept in all, ``skipped`` counts missed ticks.
    """
    begin_tick(s.failures)
    slept = slept_s - s.last_sleep_s
    s.last_sleep_s = slept_s
    s.step_s = now - s.last_tick if s.has_ticked else p.period_s
    gap_s = s.step_s + max(slept, 0.0) if s.has_ticked else 0.0
    s.last_tick = now
    s.has_ticked = True
    longest_gap_s = p.stall_limit + p.period_s
    if gap_s > longest_gap_s:
        restart(p, s, slept > longest_gap_s)
        return True
    note_tick(p, s.overrun, now, skipped)
    return False


@kernel
def restart(p, s, has_slept):
    """Begin anew; a vehicle that nobody else brakes is stopped first, if it was not asleep."""
    s.step_s = p.period_s
    if p.has_ramp and not has_slept and drives(s.life.state):
        set_life(s, Life(STOP, STALLED, STALLED))
        enter(s.stop, STOP, s.speed)
    elif s.life.state != SILENT:  # what is latched stays so
        set_life(s, Life(INIT, STALLED, NONE))
    s.barred = STALLED
    s.only_path = False
    forget_failures(s.failures, s.overrun)


@kernel
def drives(state):
    """Whether commands that are sent drive the vehicle."""
    return state == ACTIVE or is_stopping(state)


@kernel
def judge(p, s, facts, now):
    """Take the FACTS of a tick; ``s.life`` then decides what it sends."""
    s.speed = facts.speed
    if facts.blocked == SECOND_ISLAND:  # whoever disengages then may mean that other one
        s.barred = RESTARTED_WHILE_MOVING
    elif facts.disengaged == NOT_AUTONOMOUS:
        s.barred = NONE
    note_facts(s.failures, facts, now)
    own = failure(p, s.failures, s.overrun, facts.refused, now)
    blocked = facts.blocked if facts.blocked != NONE else own
    is_of_path = blocked == NONE or (facts.unfollowable and is_lost_path(blocked))
    advance(p, s, blocked, facts.disengaged, facts.arm, is_of_path)


@kernel
def is_lost_path(blocked):
    """Whether a trajectory that cannot be followed may end in this reason."""
    return blocked in (NO_TRAJECTORY, INPUT_STALE, MPC_FAILED)


@kernel
def fault(p, s):
    """Note a tick that ended with an exception; too many end the output as other causes do.

    A stop that has begun goes on. The operation mode is unknown, so an armed island stays armed.
    """
    if note_crash(p, s.failures) or is_stopping(s.life.state):
        advance(p, s, CONTROLLER_FAULT, NONE, False, False)


@kernel
def advance(p, s, blocked, disengaged, arm, is_of_path):
    """Make this tick's transition, and what follows from it."""
    before = Life(s.life.state, s.life.reason, s.life.cause)
    is_moving = not abs(s.speed) < p.moving_speed  # so is one of unknown speed
    may_wait = is_of_path and not is_moving and disengaged == NONE
    s.only_path = may_wait and (s.only_path or not is_stopping(before.state))
    now = Conditions(
        blocked,
        disengaged,
        s.barred if is_moving else NONE,
        arm,
        p.has_ramp,
        hold_over(p, s.stop),
        s.stop.ramp.is_over,
        s.only_path,
    )
    after = next_life(before, now)
    set_life(s, after)
    if s.only_path and before.state != INIT and after.state == INIT:
        s.barred = RESTARTED_WHILE_MOVING  # it goes on by itself only where it stood
    if after.state == INIT or after.state == SILENT:
        s.failures.outputs.count = 0  # nothing is sent: what is not tried cannot fail
    enter(s.stop, after.state, s.speed)


@kernel
def motion(p, s, out):
    """Set ``out`` to the command that HOLD and STOP send in place of the controllers'.

    False when the state has none.
    """
    return next_motion(p, s.stop, s.life.state, max(s.step_s, 0.5 * p.period_s), out)


@kernel
def sent(s, command, went_out, now):
    """Note a command (MOTION) of the controllers that went out, or that no output could take."""
    note(s.failures.outputs, not went_out, now)
    if went_out:
        copy_motion(s.stop.last_sent, command)


@kernel
def controls(s):
    """Whether the controllers may count on being followed."""
    state = s.life.state
    return state in (ACTIVE, READY, INIT, HOLD)


@kernel
def is_armed(s):
    """Whether the vehicle is under control, or may be again without being engaged anew."""
    return drives(s.life.state) or (s.life.state == READY and s.life.cause != NONE)


@kernel
def must_stop(p, s):
    """Whether commands may not just end: the vehicle hears only CAN, and is not at rest.

    A stop that has begun is carried through. It always comes to its end, since it follows the
    time and no measurement.
    """
    if is_stopping(s.life.state):
        return True
    if not p.has_ramp or s.life.state != ACTIVE:
        return False
    last = s.stop.last_sent
    is_at_rest = abs(s.speed) < p.moving_speed and abs(last.velocity) < p.moving_speed
    return not (is_at_rest and last.acceleration <= 0.0)


@entry(LIFE_PARAMS, LIFE_STATE)
def life_start(params, state):
    """Set the start values of a state that is all zero."""
    start(params[0], state[0])
    return 0


@entry(LIFE_PARAMS, LIFE_STATE, float, float, int)
def life_begin(params, state, now, slept_s, skipped):
    """Begin a tick; 1 when the process stood still, and everything begins anew."""
    return int(begin(params[0], state[0], now, slept_s, skipped))


@entry(LIFE_PARAMS, LIFE_STATE, FACTS, float)
def life_judge(params, state, facts, now):
    """Take the facts of a tick; the state's ``life`` then decides what it sends."""
    judge(params[0], state[0], facts[0], now)
    return 0


@entry(LIFE_PARAMS, LIFE_STATE)
def life_fault(params, state):
    """Note a tick that ended with an exception."""
    fault(params[0], state[0])
    return 0


@entry(LIFE_PARAMS, LIFE_STATE, MOTION)
def life_motion(params, state, command):
    """Set the command that HOLD and STOP send in place of the controllers'; 0: there is none."""
    return int(motion(params[0], state[0], command[0]))


@entry(LIFE_STATE, MOTION, int, float)
def life_sent(state, command, went_out, now):
    """Note a command of the controllers that went out, or that no output could take (0)."""
    sent(state[0], command[0], went_out != 0, now)
    return 0


@entry(LIFE_PARAMS, LIFE_STATE)
def life_flags(params, state):
    """Bits of LifeFlag: what else follows from the state."""
    flags = CONTROLS if controls(state[0]) else 0
    flags += ARMED if is_armed(state[0]) else 0
    return flags + (MUST_STOP if must_stop(params[0], state[0]) else 0)
