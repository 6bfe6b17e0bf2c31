# SPDX-License-Identifier: Apache-2.0
"""The life cycle as one pure function: from state and conditions to the next state."""

from typing import NamedTuple

from safety_island.kernel.kernel import kernel
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State

INIT = int(State.INIT)
READY = int(State.READY)
ACTIVE = int(State.ACTIVE)
HOLD = int(State.HOLD)
STOP = int(State.STOP)
SILENT = int(State.SILENT)
NONE = int(Reason.NONE)
NOT_AUTONOMOUS = int(Reason.NOT_AUTONOMOUS)
LATCHED = int(Reason.LATCHED)


class Conditions(NamedTuple):
    """What one tick found out."""

    blocked: Reason
    """Why nothing may be sent now, NONE when something may: what is missing, or what went wrong."""
    disengaged: Reason
    """Why the vehicle is not under control, NONE when it is."""
    barred: Reason
    """Why the island must not arm itself, NONE when it may."""
    arm: bool
    """Somebody asked for it."""
    has_ramp: bool
    """The vehicle hears nobody else who could brake it (CAN_ONLY)."""
    hold_over: bool
    """The last command was repeated often enough."""
    ramp_over: bool
    """The stop ramp has come to its end."""
    only_path: bool = False
    """Nothing is lost but a trajectory that can be followed, and the vehicle has stood since."""


class Life(NamedTuple):
    """The state, why, and for what cause an armed island fell out of ACTIVE (NONE: it did not).

    READY with a cause is still armed: the publisher of the operation mode has gone, and whatever
    else is lost before it is back ends in silence.
    """

    state: State
    reason: Reason
    cause: Reason = Reason.NONE


@kernel
def next_life(life, now):
    """Return the next Life; every pair is in ``tests/life_cycle/test_transition.py``."""
    state, _, cause = life
    if state == SILENT:
        return from_silent(cause, now)
    if now.disengaged == NOT_AUTONOMOUS:  # an operator's act; an unknown mode is none
        return unarmed(now)
    if state in (HOLD, STOP):
        return from_stop(state, cause, now)
    return from_armed(now) if state == ACTIVE or cause != NONE else unarmed(now)


@kernel
def unarmed(now):
    """From INIT and READY, and from any state that an operator leaves by disengaging."""
    if now.blocked != NONE:
        return Life(INIT, now.blocked, NONE)
    if now.disengaged != NONE:
        return Life(READY, now.disengaged, NONE)
    if now.barred != NONE and not now.arm:
        return Life(SILENT, now.barred, now.barred)
    return Life(ACTIVE, NONE, NONE)


@kernel
def from_armed(now):
    """Out of ACTIVE: silence, at which Autoware brakes; without Autoware, hold and then stop.

    Its gate alone does not brake when commands end: ``topic_state_monitor`` times out, and
    ``mrm_handler`` then has the vehicle stopped. While just the mode is unknown, commands go on,
    so that these need not act. A vehicle that stands and lacks only a trajectory that it could
    follow may drive on when one comes.
    """
    lost = lost_by(now)
    if lost == NONE:
        return Life(ACTIVE, NONE, NONE)
    if now.has_ramp:
        return Life(STOP if now.hold_over else HOLD, lost, lost)
    if now.blocked != NONE and may_wait(now):
        return unarmed(now)
    return Life(SILENT if now.blocked != NONE else READY, lost, lost)


@kernel
def lost_by(now):
    """Reason why an armed island does not drive; NONE when it may."""
    return now.blocked if now.blocked != NONE else now.disengaged


@kernel
def may_wait(now):
    """Whether what was lost needs no operator: the vehicle stands, and lacks but a trajectory."""
    return now.only_path and now.disengaged == NONE


@kernel
def from_stop(state, cause, now):
    """From HOLD back when the cause has gone; a stop that has begun is carried through."""
    lost = lost_by(now)
    if state == HOLD and lost == NONE:
        return Life(ACTIVE, NONE, NONE)
    if state == STOP and now.ramp_over:
        if may_wait(now):
            return unarmed(now)
        return Life(SILENT, lost if lost != NONE else LATCHED, cause)
    is_stop = state == STOP or now.hold_over
    return Life(STOP if is_stop else HOLD, lost if lost != NONE else cause, cause)


@kernel
def from_silent(cause, now):
    """Latched: out of it only by an explicit act, and never while a cause stands."""
    if now.blocked != NONE:
        return Life(SILENT, now.blocked, cause)
    if now.disengaged == NOT_AUTONOMOUS:
        return Life(READY, now.disengaged, NONE)
    if now.disengaged != NONE:  # nobody has left autonomous mode: its publisher went
        return Life(SILENT, now.disengaged, cause)
    if now.arm:
        return Life(ACTIVE, NONE, NONE)
    return Life(SILENT, cause if cause == now.barred else LATCHED, cause)
