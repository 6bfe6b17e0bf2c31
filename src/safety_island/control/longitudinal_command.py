# SPDX-License-Identifier: Apache-2.0
"""The acceleration and speed command of each longitudinal state, and the limits on it."""

import math

import numpy as np

from safety_island.control.geometry import clip, diff_limit, time_since
from safety_island.control.pid import low_pass, pid_step
from safety_island.control.slope import slope_acceleration, slope_pull
from safety_island.control.smooth_stop import smooth_stop_acc, smooth_stop_mode
from safety_island.control.status import LongitudinalState
from safety_island.control.trajectory_walk import stop_index
from safety_island.kernel.kernel import kernel

DRIVE = int(LongitudinalState.DRIVE)
EMERGENCY = int(LongitudinalState.EMERGENCY)


@kernel
def beyond(new, previous, dt, low, high):
    """Whether the rate of change from ``previous`` to ``new`` lies outside [low, high]."""
    rate = (new - previous) / dt
    return rate < low or rate > high


@kernel
def integration_enabled(p, s, v, now):
    """Whether the PID may integrate: under control, and moving or stuck for long enough."""
    if not s.under_control:
        return False
    if abs(v) > p.current_vel_threshold_pid_integration:
        return True
    waited = time_since(p, now, s.under_control_since)
    is_stuck = waited >= p.time_threshold_before_pid_integration
    return p.enable_integration_at_low_speed and is_stuck


@kernel
def speed_feedback(p, s, target, v, now, t):
    """Acceleration [m/s^2] that follows the target: its own, scaled, plus the PID of the error."""
    target_v = np.float64(target.v)
    error = target_v - v if s.gear_forward else v - target_v
    s.vel_error = low_pass(s.vel_error, p.lpf_vel_error_gain, error)
    integrate = integration_enabled(p, s, v, now)
    pid_acc, t.pid_p, t.pid_i, t.pid_d = pid_step(p, s.pid, s.vel_error, s.dt, integrate)
    t.err_vel_filtered = s.vel_error
    t.ff_scale = clip(abs(v) / max(abs(target_v), 0.1), p.ff_scale_min, p.ff_scale_max)
    t.acc_ff = np.float64(target.acc) * t.ff_scale
    t.acc_pid_applied = t.acc_ff + pid_acc
    return t.acc_pid_applied


@kernel
def keep_braking(p, s, work, acc, t):
    """Hold the last braking of the trajectory's ramp down to the stop point, when enabled."""
    stop = stop_index(work, s.n) if p.enable_brake_keeping_before_stop else -1
    if stop < 0:
        return acc
    lowest = math.inf
    ramp = stop
    for i in range(stop, -1, -1):
        if np.float64(work[i].acc) > lowest:
            break
        lowest = np.float64(work[i].acc)
        ramp = i
    held = max(p.brake_keeping_acc, lowest)
    if s.target < ramp or acc <= held:
        return acc
    t.brake_keeping = True
    return held


@kernel
def limit_raw(p, s, acc, t):
    """Clip an acceleration and limit its jerk against the previous raw command."""
    t.acc_acc_limited = clip(acc, p.min_acc, p.max_acc)
    t.acc_limited = t.acc_acc_limited != acc
    t.acc_jerk_limited = diff_limit(t.acc_acc_limited, s.raw_acc, s.dt, p.min_jerk, p.max_jerk)
    t.jerk_limited = beyond(t.acc_acc_limited, s.raw_acc, s.dt, p.min_jerk, p.max_jerk)
    return t.acc_jerk_limited


@kernel
def emergency_command(p, s, t):
    """Set the raw command of an emergency: speed toward its own, braking with limited jerk."""
    rate = abs(p.emergency_acc)
    jerk = abs(p.emergency_jerk)
    s.raw_vel = diff_limit(p.emergency_vel, s.raw_vel, s.dt, -rate, rate)
    t.acc_acc_limited = clip(p.emergency_acc, p.min_acc, p.max_acc)
    t.acc_limited = t.acc_acc_limited != p.emergency_acc
    t.acc_jerk_limited = diff_limit(t.acc_acc_limited, s.raw_acc, s.dt, -jerk, jerk)
    t.jerk_limited = beyond(t.acc_acc_limited, s.raw_acc, s.dt, -jerk, jerk)
    s.raw_acc = t.acc_jerk_limited


@kernel
def raw_command(p, u, s, work, now, t):
    """Set the raw command of DRIVE, STOPPING or EMERGENCY."""
    if s.state == EMERGENCY:
        emergency_command(p, s, t)
        return
    if s.state == DRIVE:
        target = work[s.target]
        acc = speed_feedback(p, s, target, u.vx, now, t)
        acc = keep_braking(p, s, work, acc, t)
        s.raw_vel = np.float64(target.v)
    else:
        t.smooth_stop_mode = smooth_stop_mode(p, s, u.vx, u.ax, now)
        acc = smooth_stop_acc(p, s, t.smooth_stop_mode)
        s.raw_vel = p.stopped_vel
    s.raw_acc = limit_raw(p, s, acc, t)


@kernel
def moving_acceleration(p, u, s, t):
    """Raw acceleration with acceleration feedback and slope compensation [m/s^2].

    The measured acceleration counts in the direction of body x; only by rule its sign is turned
    into the gear's.
    """
    measured = -u.ax if p.feedback_turns_in_reverse and not s.gear_forward else u.ax
    s.acc_error = low_pass(s.acc_error, p.lpf_acc_error_gain, measured - s.raw_acc)
    t.acc_fb_applied = s.raw_acc - s.acc_error * p.acc_feedback_gain
    t.acc_slope_applied = t.acc_fb_applied + slope_acceleration(p, s)
    t.pitch_limited = p.enable_slope_compensation and not (
        p.min_pitch_rad <= s.slope <= p.max_pitch_rad
    )
    return t.acc_slope_applied


@kernel
def stopped_acceleration(p, s, t):
    """Braking that holds the vehicle [m/s^2]; the raw command's memory is reset."""
    s.raw_vel = 0.0
    s.raw_acc = 0.0
    t.acc_acc_limited = p.stopped_acc
    t.acc_jerk_limited = p.stopped_acc
    t.acc_slope_applied = p.stopped_acc
    if p.stopped_adds_slope and p.enable_slope_compensation:
        t.acc_slope_applied = p.stopped_acc - abs(slope_pull(p, s))
    return t.acc_slope_applied


@kernel
def limit_output(p, s, acc, t):
    """Limit the change against the last output and remember the result [m/s^2]."""
    most = p.max_acc_cmd_diff
    t.diff_limited = beyond(acc, s.prev_acc, s.dt, -most, most)
    s.prev_acc = diff_limit(acc, s.prev_acc, s.dt, -most, most)
