# SPDX-License-Identifier: Apache-2.0
"""The life cycle as one pure function: from state and conditions to the next state."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State


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


_WELL = Life(State.ACTIVE, Reason.NONE)


def next_life(life: Life, now: Conditions) -> Life:
    """Return the next state; every pair is in ``tests/life_cycle/test_transition.py``."""
    state, _, cause = life
    if state is State.SILENT:
        return _silent(cause, now)
    if now.disengaged is Reason.NOT_AUTONOMOUS:  # an act of an operator; a mode unknown is none
        return _unarmed(now)
    if state in (State.HOLD, State.STOP):
        return _stop(state, cause, now)
    return _armed(now) if state is State.ACTIVE or cause else _unarmed(now)


def _unarmed(now: Conditions) -> Life:
    """From INIT and READY, and from any state that an operator leaves by disengaging."""
    if now.blocked:
        return Life(State.INIT, now.blocked)
    if now.disengaged:
        return Life(State.READY, now.disengaged)
    if now.barred and not now.arm:
        return Life(State.SILENT, now.barred, now.barred)
    return _WELL


def _armed(now: Conditions) -> Life:
    """Out of ACTIVE: silence, since a gate brakes; without one, hold and then stop.

    While just the mode is unknown, the gate is told as before, and need not brake for it. A vehicle
    that stands and lacks only a trajectory that it could follow may drive on when one comes.
    """
    lost = now.blocked or now.disengaged
    if not lost:
        return _WELL
    if now.has_ramp:
        return Life(State.STOP if now.hold_over else State.HOLD, lost, lost)
    if now.blocked and _may_wait(now):
        return _unarmed(now)
    return Life(State.SILENT if now.blocked else State.READY, lost, lost)


def _may_wait(now: Conditions) -> bool:
    """Whether what was lost needs no operator: the vehicle stands, and lacks but a trajectory."""
    return now.only_path and not now.disengaged


def _stop(state: State, cause: Reason, now: Conditions) -> Life:
    """From HOLD back when the cause has gone; a stop that has begun is carried through."""
    lost = now.blocked or now.disengaged
    if state is State.HOLD and not lost:
        return _WELL
    if state is State.STOP and now.ramp_over:
        return (
            _unarmed(now) if _may_wait(now) else Life(State.SILENT, lost or Reason.LATCHED, cause)
        )
    is_stop = state is State.STOP or now.hold_over
    return Life(State.STOP if is_stop else State.HOLD, lost or cause, cause)


def _silent(cause: Reason, now: Conditions) -> Life:
    """Latched: out of it only by an explicit act, and never while a cause stands."""
    if now.blocked:
        return Life(State.SILENT, now.blocked, cause)
    if now.disengaged is Reason.NOT_AUTONOMOUS:
        return Life(State.READY, now.disengaged)
    if now.disengaged:  # nobody has left autonomous mode: its publisher went
        return Life(State.SILENT, now.disengaged, cause)
    if now.arm:
        return _WELL
    return Life(State.SILENT, Reason.LATCHED if cause is not now.barred else cause, cause)
