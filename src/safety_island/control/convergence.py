# SPDX-License-Identifier: Apache-2.0
"""Whether steering and trajectory have come to rest: the memories of the lateral wrapper."""

import math

from safety_island.control.geometry import time_since
from safety_island.control.limits import MAX_HISTORY, MAX_SHAPE_HISTORY
from safety_island.kernel.kernel import kernel

_HISTORY_SECONDS = 1.0


@kernel
def remember_end(params, lat, x, y, stamp):
    """Remember the end point of an accepted trajectory and forget those of too long ago.

    One from the future goes as well: the planner's clock was set back, or one stamp was wrong, and
    waiting until that time has come would hold the shape as changed.
    """
    n = lat.ends_n
    if n == MAX_SHAPE_HISTORY:
        _forget_ends(lat, 1)
        n -= 1
    lat.ends_x[n] = x
    lat.ends_y[n] = y
    lat.ends_t[n] = stamp
    lat.ends_n = n + 1
    old = 0
    while old < n and not 0.0 <= stamp - lat.ends_t[old] < params.new_traj_duration_time:
        old += 1
    if old > 0:
        _forget_ends(lat, old)


@kernel
def _forget_ends(lat, count):
    for i in range(count, lat.ends_n):
        lat.ends_x[i - count] = lat.ends_x[i]
        lat.ends_y[i - count] = lat.ends_y[i]
        lat.ends_t[i - count] = lat.ends_t[i]
    lat.ends_n -= count


@kernel
def has_shape_changed(params, points, inputs, lat):
    """Whether a remembered end point lies apart from the end of the trajectory in force."""
    last = points[inputs.n_points - 1]
    for i in range(lat.ends_n):
        dx = lat.ends_x[i] - last.x
        dy = lat.ends_y[i] - last.y
        if math.sqrt(dx * dx + dy * dy) > params.new_traj_end_dist:
            return True
    return False


@kernel
def remember_command(params, lat, angle, now):
    """Append a command to the history of about one second.

    An entry is dropped only when the one behind it is old too, as the firmware's loop has it.
    """
    n = lat.history_n
    if n == MAX_HISTORY:
        _forget_commands(lat)
        n -= 1
    lat.history_u[n] = angle
    lat.history_t[n] = now
    lat.history_n = n + 1
    lat.history_filled = time_since(params, now, lat.history_t[0]) >= _HISTORY_SECONDS
    i = 0
    while i < lat.history_n and _is_old(params, time_since(params, now, lat.history_t[i])):
        _forget_commands(lat)
        i += 1


@kernel
def _is_old(params, age):
    """Whether a command of this age [s] is dropped from the history."""
    return age > _HISTORY_SECONDS if params.history_exceeds_second else age >= _HISTORY_SECONDS


@kernel
def _forget_commands(lat):
    for i in range(1, lat.history_n):
        lat.history_u[i - 1] = lat.history_u[i]
        lat.history_t[i - 1] = lat.history_t[i]
    lat.history_n -= 1


@kernel
def is_mpc_converged(params, lat):
    """Whether the commands of the last second lie close together."""
    if lat.history_n < 2 or not lat.history_filled:
        return False
    low = lat.history_u[0]
    high = low
    for i in range(1, lat.history_n):
        low = min(low, lat.history_u[i])
        high = max(high, lat.history_u[i])
    return high - low < params.mpc_converged_threshold_rps


@kernel
def is_steer_converged(params, points, inputs, lat, angle):
    """Whether the measured angle has reached ``angle`` [rad] on an unchanged trajectory."""
    if has_shape_changed(params, points, inputs, lat):
        return False
    return abs(angle - lat.measured) < params.converged_steer_rad
