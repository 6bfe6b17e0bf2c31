# SPDX-License-Identifier: Apache-2.0
"""Short memories of commands and speeds, and the state that they predict after the delay."""

import math

import numpy as np

from safety_island.control.geometry import time_since, whole_nanoseconds
from safety_island.control.limits import MAX_HISTORY
from safety_island.control.status import LongitudinalState, Mode
from safety_island.kernel.kernel import kernel

AUTONOMOUS = int(Mode.AUTONOMOUS)
DRIVE = int(LongitudinalState.DRIVE)


@kernel
def forget_oldest(values, times, n):
    """Drop the first entry of a history; return how many are left."""
    for i in range(1, n):
        values[i - 1] = values[i]
        times[i - 1] = times[i]
    return n - 1


@kernel
def store_command(p, s, now):
    """Remember the raw acceleration of a DRIVE tick; any other state empties the memory."""
    if s.state != DRIVE:
        s.commands_n = 0
        return
    if s.commands_n == MAX_HISTORY:
        s.commands_n = forget_oldest(s.commands_acc, s.commands_stamp, s.commands_n)
    acc = s.raw_acc
    s.commands_acc[s.commands_n] = acc if p.double_command_history else np.float64(np.float32(acc))
    s.commands_stamp[s.commands_n] = now if p.whole_nanoseconds else whole_nanoseconds(now)
    s.commands_n += 1
    since_second = time_since(p, now, s.commands_stamp[1])
    if s.commands_n > 2 and since_second > p.delay_compensation_time:
        s.commands_n = forget_oldest(s.commands_acc, s.commands_stamp, s.commands_n)


@kernel
def _append_speed(s, vx, now):
    s.speeds_v[s.speeds_n] = vx
    s.speeds_t[s.speeds_n] = now
    s.speeds_n += 1


@kernel
def store_speed_first(p, s, vx, now):
    """At the start of a tick remember the measured speed, and forget those older than the delay."""
    if not p.speeds_by_time:
        return
    if s.speeds_n == MAX_HISTORY:
        s.speeds_n = forget_oldest(s.speeds_v, s.speeds_t, s.speeds_n)
    _append_speed(s, vx, now)
    while time_since(p, now, s.speeds_t[0]) > p.delay_compensation_time:
        s.speeds_n = forget_oldest(s.speeds_v, s.speeds_t, s.speeds_n)


@kernel
def store_speed_last(p, s, vx, now):
    """At the end of a tick remember the measured speed; the newest ``delay / period`` stay."""
    if p.speeds_by_time:
        return
    keep = min(int(p.delay_compensation_time / p.ctrl_period), MAX_HISTORY)
    while s.speeds_n > 0 and s.speeds_n >= keep:
        s.speeds_n = forget_oldest(s.speeds_v, s.speeds_t, s.speeds_n)
    if keep > 0:
        _append_speed(s, vx, now)


@kernel
def predict_from_measurement(p, s, v, a):
    """Predict with the measured acceleration, but not beyond standstill."""
    t = p.delay_compensation_time
    if a != 0.0 and 0.0 < -v / a < t:
        t = -v / a
    s.pred_vel = v + a * t
    s.pred_dist = abs(t * v + 0.5 * a * t * t)


@kernel
def predict_from_commands(p, s, v, now):
    """Predict by playing the stored commands; a change of direction ends at standstill.

    An acceleration is positive in the direction of motion, so a negative speed grows by minus it.
    Each command counts with its whole step: nothing is cut off at the delay.
    """
    delay = p.delay_compensation_time
    s.pred_vel = v
    s.pred_dist = 0.0
    for i in range(s.commands_n):
        age = time_since(p, now, s.commands_stamp[i])
        if age >= delay:
            continue
        t = age
        if i < s.commands_n - 1:
            t = time_since(p, s.commands_stamp[i + 1], s.commands_stamp[i])
        t = min(t, delay)
        a = s.commands_acc[i]
        s.pred_dist += abs(abs(s.pred_vel) * t + 0.5 * a * t * t)
        s.pred_vel += -a * t if s.pred_vel < 0.0 else a * t
        if s.pred_vel != 0.0 and math.copysign(1.0, s.pred_vel) != math.copysign(1.0, v):
            s.pred_vel = 0.0
            return


@kernel
def predict_after_delay(p, u, s, now):
    """Set the speed after the delay and the distance run until then. Enabled does not count."""
    if s.commands_n == 0 or u.mode != AUTONOMOUS:
        predict_from_measurement(p, s, u.vx, u.ax)
    else:
        predict_from_commands(p, s, u.vx, now)
