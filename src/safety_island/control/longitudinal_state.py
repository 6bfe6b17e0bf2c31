# SPDX-License-Identifier: Apache-2.0
"""Everything that the longitudinal controller remembers, and the values of one tick."""

from __future__ import annotations

import numpy as np

from safety_island.control.limits import MAX_HISTORY, MAX_POINTS
from safety_island.control.records import POINT
from safety_island.control.status import LongitudinalState
from safety_island.kernel.records import Records, record

LIST_CAPACITY = MAX_POINTS + 2
"""Points of the working list: a whole trajectory, the ego's point and the target point."""

PID_MEMORY = record(
    [
        ("integral", "f8"),  # of the filtered speed error [m]
        ("error_prev", "f8"),  # [m/s]
        ("started", "?"),  # error_prev is set
    ]
)

STATE_COLUMNS = [
    ("state", "i4"),  # LongitudinalState
    ("gear_forward", "?"),
    ("is_steer_converged", "?"),  # of the lateral side in the previous tick; the caller sets it
    ("ran_before", "?"),  # time_prev is set
    ("time_prev", "f8"),  # of the previous tick [s]
    ("moved_before", "?"),  # last_running_time is set
    ("last_running_time", "f8"),  # [s]
    ("under_control_prev", "?"),
    ("under_control_since", "f8"),  # [s]
    ("kept_recorded", "?"),  # kept_prev is set
    ("slope_started", "?"),  # slope_prev is set
    ("kept_prev", "?"),  # standing with unconverged steering at the last record
]

COMMAND_COLUMNS = [
    ("raw_vel", "f8"),  # previous command before feedback, slope and the last limit [m/s]
    ("raw_acc", "f8"),  # [m/s^2]
    ("prev_acc", "f8"),  # previous output [m/s^2]
    ("vel_error", "f8"),  # low-passed speed error [m/s]
    ("acc_error", "f8"),  # low-passed acceleration error [m/s^2]
    ("pitch", "f8"),  # low-passed pitch of the body, positive uphill [rad]
    ("slope_prev", "f8"),  # slope of the previous tick before the pitch limits [rad]
    ("pid", PID_MEMORY),
    ("weak_time", "f8"),  # when smooth stop last braked weakly while running [s]
    ("strong_acc", "f8"),  # strong braking of this smooth stop [m/s^2]
    ("commands_n", "i8"),  # accelerations of the last DRIVE ticks, oldest first
    ("commands_acc", "f8", (MAX_HISTORY,)),  # [m/s^2]
    ("commands_stamp", "f8", (MAX_HISTORY,)),  # [s]
    ("speeds_n", "i8"),  # measured speeds of the last ticks, oldest first
    ("speeds_v", "f8", (MAX_HISTORY,)),  # signed [m/s]
    ("speeds_t", "f8", (MAX_HISTORY,)),  # [s]
]

TICK_COLUMNS = [
    ("dt", "f8"),  # since the previous tick, limited [s]
    ("n", "i8"),  # points of the working list
    ("nearest", "i8"),  # index of the ego's point in it
    ("target", "i8"),  # index of the target point
    ("times", "f8", (LIST_CAPACITY,)),  # of the points of the list (temporal mode) [s]
    ("ego_point", POINT),  # the trajectory where the ego is
    ("target_point", POINT),  # the trajectory where the ego will be after the delay
    ("stop_dist", "f8"),  # [m]
    ("pred_vel", "f8"),  # after the delay [m/s]
    ("pred_dist", "f8"),  # run until then [m]
    ("slope", "f8"),  # [rad], positive uphill
    ("slope_from_trajectory", "?"),
    ("under_control", "?"),
]

LONGITUDINAL_STATE = record(STATE_COLUMNS + COMMAND_COLUMNS + TICK_COLUMNS)
"""Memories first, then what one tick computes for its own later steps."""

TRACE_START = [
    "stop_dist",
    "target_vel",
    "target_acc",
    "nearest_vel",
    "pred_vel",
    "slope_angle",
    "err_vel_filtered",
    "pid_p",
    "pid_i",
    "pid_d",
    "ff_scale",
    "acc_ff",
    "acc_pid_applied",
    "acc_acc_limited",
    "acc_jerk_limited",
    "acc_fb_applied",
    "acc_slope_applied",
]
"""Columns of the trace that are NaN until a tick sets them."""


def reset_longitudinal(state: Records) -> None:
    """Set the start values: STOPPED, gear forward, every memory empty or zero."""
    state[0] = np.zeros((), state.dtype)
    state[0].state = LongitudinalState.STOPPED
    state[0].gear_forward = True


def reset_longitudinal_trace(trace: Records) -> None:
    """Set the longitudinal columns of a TRACE to what they are before the first tick."""
    for name in TRACE_START:
        trace[name] = np.nan
    for name in ("trans_dev", "rot_dev", "prev_raw_acc", "prev_raw_vel", "prev_acc"):
        trace[name] = 0.0
    trace["lon_state"] = LongitudinalState.STOPPED
    trace["gear_forward"] = True
    trace["smooth_stop_mode"] = -1


def new_longitudinal_state() -> Records:
    """Return the (1,) start state."""
    state: Records = np.zeros(1, LONGITUDINAL_STATE)
    reset_longitudinal(state)
    return state


def new_longitudinal_work() -> Records:
    """Return the work memory of a tick: POINT records, shape (LIST_CAPACITY,)."""
    return np.zeros(LIST_CAPACITY, POINT)
