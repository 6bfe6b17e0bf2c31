# SPDX-License-Identifier: Apache-2.0
"""The four states of the longitudinal controller: which comes next, and what a change resets."""

from safety_island.control.geometry import time_since
from safety_island.control.pid import pid_reset
from safety_island.control.smooth_stop import smooth_stop_start
from safety_island.control.status import LongitudinalState
from safety_island.control.trajectory_walk import STANDING
from safety_island.kernel.kernel import kernel

DRIVE = int(LongitudinalState.DRIVE)
STOPPING = int(LongitudinalState.STOPPING)
STOPPED = int(LongitudinalState.STOPPED)
EMERGENCY = int(LongitudinalState.EMERGENCY)


@kernel
def next_state(
    state, smooth, emergency, under_control, stopped, stopping, departing, departing_far, kept
):
    """State after one tick; a pure function, at most one transition.

    ``smooth``: smooth stop is on. ``stopping``, ``departing``, ``departing_far``: the stop point is
    nearer than, farther than the STOPPED limit, farther than the STOPPING limit. ``kept``: held
    until the steering has converged.
    """
    if state == DRIVE:
        if emergency:
            return EMERGENCY
        if stopped and not under_control:
            return STOPPED
        if smooth:
            return STOPPING if stopping else DRIVE
        return STOPPED if stopped and not departing else DRIVE
    if state == STOPPING:
        if emergency:
            return EMERGENCY
        if stopped:
            return STOPPED
        return DRIVE if departing_far else STOPPING
    if state == STOPPED:
        return DRIVE if departing and not kept else STOPPED
    if stopped:
        return STOPPED
    return DRIVE if not emergency and not under_control else EMERGENCY


@kernel
def has_stopped(p, s, v, now):
    """Whether the vehicle has not run for a while; before it ran for the first time only by rule.

    Running backward against the gear, on a slope for example, counts as not running.
    """
    if p.counts_from_start and not s.moved_before:
        s.moved_before = True
        s.last_running_time = now
    against_gear = v < 0.0 if s.gear_forward else v > 0.0
    if not (abs(v) < p.stopped_state_entry_vel or against_gear):
        s.moved_before = True
        s.last_running_time = now
    elapsed = time_since(p, now, s.last_running_time)
    return s.moved_before and elapsed > p.stopped_state_entry_duration_time


@kernel
def keep_stopped(p, s, v, departing):
    """Whether a departure waits for the steering: it takes two converged records in a row."""
    if s.state != STOPPED:
        s.kept_recorded = False
        return False
    if not departing:
        return False
    unconverged = abs(v) < STANDING and not s.is_steer_converged
    kept = not s.kept_recorded or unconverged or s.kept_prev
    s.kept_recorded = True
    s.kept_prev = unconverged
    return kept and p.enable_keep_stopped_until_steer_convergence


@kernel
def enter(p, s, old, v, now):
    """What a change from ``old`` to ``s.state`` resets or starts."""
    if old == DRIVE and s.state == STOPPING:
        run = 0.5 * (s.pred_vel + v) * p.delay_compensation_time
        smooth_stop_start(p, s, s.pred_vel, s.stop_dist - run, now)
    elif s.state == DRIVE and old == STOPPING:
        pid_reset(s.pid)
        s.vel_error = 0.0
        # the jerk limit starts without the last braking; until 0.45 only the output's limit did
        if p.drive_resets_raw:
            s.raw_acc = max(0.0, s.raw_acc)
        else:
            s.prev_acc = max(0.0, s.raw_acc)
    elif s.state == DRIVE and old == STOPPED:
        pid_reset(s.pid)
        s.vel_error = 0.0
        s.acc_error = 0.0


@kernel
def advance_state(p, s, v, nearest_v, now, t):
    """Make this tick's transition."""
    stopped = has_stopped(p, s, v, now)
    if s.under_control != s.under_control_prev:
        s.under_control_prev = s.under_control
        s.under_control_since = now
    overshot = s.stop_dist < -p.emergency_state_overshoot_stop_dist and abs(nearest_v) < STANDING
    departing = s.stop_dist > p.drive_state_stop_dist
    old = s.state
    if p.stopped_in_manual and old == STOPPED and stopped and not s.under_control:
        t.slow_start_held = False
        return
    kept = keep_stopped(p, s, v, departing)
    s.state = next_state(
        old,
        p.enable_smooth_stop,
        overshot and p.enable_overshoot_emergency,
        s.under_control,
        stopped,
        s.stop_dist < p.stopping_state_stop_dist,
        departing,
        s.stop_dist > p.drive_state_stop_dist + p.drive_state_offset_stop_dist,
        kept,
    )
    t.slow_start_held = kept
    enter(p, s, old, v, now)
