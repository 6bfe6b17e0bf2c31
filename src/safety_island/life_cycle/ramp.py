# SPDX-License-Identifier: Apache-2.0
"""What CAN_ONLY sends in place of the controllers' commands: the last one again, then a ramp.

The ramp is the declared stop: brake with a bounded jerk, hold at standstill, then silence. It leads
the last command to a standstill, tick by tick, and needs no measurement: the speed follows from the
commanded acceleration, in the direction in which the vehicle went.
"""

from typing import NamedTuple

from safety_island.kernel.kernel import kernel
from safety_island.life_cycle.params import StopSteering
from safety_island.life_cycle.state import State

HOLD = int(State.HOLD)
STOP = int(State.STOP)
HOLD_ANGLE = int(StopSteering.HOLD)


class Motion(NamedTuple):
    """A command: tyre angle [rad], its rate [rad/s], speed [m/s], acceleration [m/s^2]."""

    angle: float
    rate: float
    velocity: float
    acceleration: float


@kernel
def is_stopping(state):
    """Whether commands are sent in place of the controllers'."""
    return state in (HOLD, STOP)


@kernel
def hold_over(p, stop):
    """Whether the last command was repeated often enough."""
    return stop.holds >= p.hold_ticks


@kernel
def enter(stop, state, speed):
    """Take the state of this tick, and the speed [m/s] that was measured last."""
    if state == STOP and not stop.ramp.has_begun:
        begin_ramp(stop.ramp, stop.last_sent, speed)
    elif not is_stopping(state):
        stop.holds = 0
        stop.ramp.has_begun = False
        stop.ramp.is_over = False


@kernel
def next_motion(p, stop, state, step_s, motion):
    """Set ``motion`` to the command ``step_s`` [s] after the last; False: the state has none."""
    if state == HOLD:
        periods = int(step_s / p.period_s + 0.5)
        stop.holds += max(periods, 1)  # ticks that were missed, too
        copy_motion(motion, stop.last_sent)
        motion.rate = 0.0
        return True
    if not stop.ramp.has_begun:
        return False
    step_ramp(p, stop.ramp, step_s, motion)
    return True


@kernel
def copy_motion(to, source):
    """Copy a MOTION."""
    to.angle = source.angle
    to.rate = source.rate
    to.velocity = source.velocity
    to.acceleration = source.acceleration


@kernel
def begin_ramp(r, last, speed):
    """Begin at the last command (MOTION) and the last measured speed [m/s]."""
    r.has_begun = True
    r.is_over = False
    r.gear = -1.0 if speed < 0.0 or (speed == 0.0 and last.velocity < 0.0) else 1.0
    r.speed = abs(speed)
    r.acceleration = min(last.acceleration, 0.0)
    r.angle = last.angle
    r.held_s = 0.0


@kernel
def step_ramp(p, r, dt, motion):
    """Set ``motion`` to the command ``dt`` [s] later.

    The ramp is over when the stopped vehicle was held for the time of the parameters.
    """
    jerk_step = p.stop_jerk * dt
    change = -p.stop_deceleration - r.acceleration
    r.acceleration += min(jerk_step, max(-jerk_step, change))
    if r.speed == 0.0:
        r.held_s += dt
        r.is_over = r.held_s >= p.stop_hold
    r.speed = max(0.0, r.speed + r.acceleration * dt)
    motion.rate = steer(p, r, dt)
    motion.angle = r.angle
    motion.velocity = r.gear * r.speed
    motion.acceleration = r.acceleration


@kernel
def steer(p, r, dt):
    """Hold the angle or lead it to the centre; return the rate [rad/s]."""
    if p.stop_steering == HOLD_ANGLE:
        return 0.0
    most = p.stop_steering_rate * dt
    change = min(most, max(-most, -r.angle))
    r.angle += change
    return change / dt
