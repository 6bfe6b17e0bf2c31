# SPDX-License-Identifier: Apache-2.0
"""One tick of the longitudinal controller: inputs in, speed and acceleration command out."""

import numpy as np

from safety_island.control.longitudinal_command import (
    emergency_command,
    limit_output,
    moving_acceleration,
    raw_command,
    stopped_acceleration,
)
from safety_island.control.longitudinal_history import (
    store_command,
    store_speed_first,
    store_speed_last,
)
from safety_island.control.longitudinal_machine import advance_state
from safety_island.control.longitudinal_state import LONGITUDINAL_STATE
from safety_island.control.longitudinal_target import (
    find_pose,
    is_far,
    locate_ego,
    locate_target,
    period_since,
    set_stop_distance,
    update_gear,
)
from safety_island.control.records import COMMAND, INPUTS, PARAMS, POINT, TRACE
from safety_island.control.slope import update_slope
from safety_island.control.status import LongitudinalSkip, LongitudinalState, Mode, SmoothStopMode
from safety_island.kernel.kernel import entry, kernel

AUTONOMOUS = int(Mode.AUTONOMOUS)
STOPPED = int(LongitudinalState.STOPPED)
EMERGENCY = int(LongitudinalState.EMERGENCY)
NO_TRAJECTORY = int(LongitudinalSkip.NO_TRAJECTORY)
NOT_USABLE = int(LongitudinalSkip.NOT_USABLE)
NO_SMOOTH_STOP = int(SmoothStopMode.NONE)

LARGEST = 1e9
"""Inputs beyond this (m, m/s, m/s^2) are no measurements; their squares are far from overflow."""


@kernel
def is_usable(u, now):
    """Whether every input is a number that can be reckoned with; NaN is not."""
    largest = max(abs(u.x), abs(u.y), abs(u.z), abs(u.vx), abs(u.ax))
    turned = abs(u.qx) + abs(u.qy) + abs(u.qz) + abs(u.qw)
    total = u.x + u.y + u.z + u.vx + u.ax + turned  # NaN hides from max, not from a sum
    return largest <= LARGEST and turned <= LARGEST and total == total and abs(now) < 9e9


@kernel
def clear_flags(t):
    """Reset what the trace tells of one tick only."""
    t.far_from_trajectory = False
    t.brake_keeping = False
    t.acc_limited = False
    t.jerk_limited = False
    t.diff_limited = False
    t.pitch_limited = False
    t.stuck_in_emergency = False
    t.slow_start_held = False
    t.smooth_stop_mode = NO_SMOOTH_STOP


@kernel
def far_tick(p, u, s, work, t):
    """Emergency command while the ego is far from its trajectory; only coming near ends it."""
    s.nearest = find_pose(p, work, s.n, s.ego_point)
    set_stop_distance(p, u, s, work)
    if p.enable_large_tracking_error_emergency:
        s.state = EMERGENCY
    emergency_command(p, s, t)
    s.prev_acc = s.raw_acc
    t.far_from_trajectory = True
    t.stuck_in_emergency = s.state == EMERGENCY
    return s.raw_vel


@kernel
def near_tick(p, u, s, work, segment, now, t):
    """State update and command while the ego is near its trajectory; return the speed [m/s]."""
    locate_target(p, u, s, work, segment, now)
    update_gear(s, work)
    set_stop_distance(p, u, s, work)
    update_slope(p, u, s, work)
    nearest_v = np.float64(work[s.nearest].v)
    advance_state(p, s, u.vx, nearest_v, now, t)
    if s.state == STOPPED:
        acc = stopped_acceleration(p, s, t)
        velocity = p.stopped_vel
    else:
        raw_command(p, u, s, work, now, t)
        acc = moving_acceleration(p, u, s, t)
        velocity = s.raw_vel
    store_command(p, s, now)
    limit_output(p, s, acc, t)
    t.target_vel = work[s.target].v
    t.target_acc = work[s.target].acc
    t.nearest_vel = nearest_v
    t.pred_vel = s.pred_vel
    t.slope_angle = s.slope
    return velocity


@kernel
def tell(s, t):
    """Write the state and the memories after the tick into the trace."""
    t.lon_state = s.state
    t.gear_forward = s.gear_forward
    t.stop_dist = s.stop_dist
    t.prev_raw_acc = s.raw_acc
    t.prev_raw_vel = s.raw_vel
    t.prev_acc = s.prev_acc


@kernel
def longitudinal_tick(params, points, inputs, state, work, command, trace, now):
    """One tick: write velocity, acceleration and longitudinal_stamp of ``command``, and ``trace``.

    ``points[:n_points]`` is the trajectory in force, ``work`` POINT memory of LIST_CAPACITY,
    ``now`` [s]. ``state[0].is_steer_converged`` is the lateral side's of the previous tick.
    Returns the LongitudinalState, or a LongitudinalSkip (< 0) that leaves memories and command.
    """
    p = params[0]
    u = inputs[0]
    s = state[0]
    t = trace[0]
    clear_flags(t)
    if not is_usable(u, now):
        return NOT_USABLE
    segment = locate_ego(p, u, s, points, work, now)
    if segment < 0:
        return NO_TRAJECTORY
    s.dt = period_since(p, s, now)
    s.under_control = u.enabled and u.mode == AUTONOMOUS
    store_speed_first(p, s, u.vx, now)
    if is_far(p, u, s, t):
        velocity = far_tick(p, u, s, work, t)
    else:
        velocity = near_tick(p, u, s, work, segment, now, t)
    store_speed_last(p, s, u.vx, now)
    tell(s, t)
    command[0].velocity = np.float32(velocity)
    command[0].acceleration = np.float32(s.prev_acc)
    command[0].longitudinal_stamp = now
    return s.state


@entry(PARAMS, POINT, INPUTS, LONGITUDINAL_STATE, POINT, COMMAND, TRACE, float)
def longitudinal_step(params, points, inputs, state, work, command, trace, now):
    """The tick on its own, callable from outside; see ``longitudinal_tick``."""
    return longitudinal_tick(params, points, inputs, state, work, command, trace, now)
