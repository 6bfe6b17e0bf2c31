# SPDX-License-Identifier: Apache-2.0
"""Where the vehicle is on its trajectory, and the point that it is controlled to."""

import math

import numpy as np

from safety_island.control.geometry import clip, normalize_angle, whole_nanoseconds, yaw_of
from safety_island.control.longitudinal_history import predict_after_delay
from safety_island.control.pid import pid_reset
from safety_island.control.point_list import (
    copy_distinct,
    insert_plainly,
    insert_point,
    interpolate_at,
    interpolate_point,
)
from safety_island.control.points import (
    distance_2d,
    nearest_index,
    offset_along,
    segment_of,
    time_of,
)
from safety_island.control.status import ReferenceMode
from safety_island.control.trajectory_walk import pose_ahead, stop_distance
from safety_island.kernel.kernel import kernel

TEMPORAL = int(ReferenceMode.TEMPORAL)

SHORTEST = 2.2e-16
"""Shortest time [s] between two points that is divided by."""

MIN_RUN = 0.01
"""A run during the delay that is not longer than this [m] does not move the target point."""

GEAR_SPEED = 1e-5
"""Target speeds up to this [m/s] leave the gear as it is."""


@kernel
def period_since(p, s, now):
    """Time [s] since the previous tick, held between half and twice the period."""
    dt = now - s.time_prev if s.ran_before else p.ctrl_period
    s.ran_before = True
    s.time_prev = now
    return clip(dt, 0.5 * p.ctrl_period, 2.0 * p.ctrl_period)


@kernel
def find_pose(p, points, n, pose):
    """Nearest index of a pose under the thresholds of the parameters."""
    yaw = yaw_of(pose.qx, pose.qy, pose.qz, pose.qw)
    return nearest_index(
        points,
        n,
        pose.x,
        pose.y,
        yaw,
        p.ego_nearest_dist_threshold,
        p.ego_nearest_yaw_threshold,
    )


@kernel
def insert_projection(p, s, work, pose, point):
    """Project a pose on the list, write the ``point`` there, insert it; return its segment."""
    nearest = find_pose(p, work, s.n, pose)
    segment = segment_of(work, s.n, nearest, pose.x, pose.y)
    interpolate_at(work, segment, pose.x, pose.y, point)
    s.n = insert_point(work, s.n, segment + 1, point)
    return segment


@kernel
def is_far(p, u, s, t):
    """Whether the ego is too far from its trajectory in distance or in yaw."""
    ego = s.ego_point
    t.trans_dev = distance_2d(ego, u)
    own = yaw_of(u.qx, u.qy, u.qz, u.qw)
    t.rot_dev = abs(normalize_angle(yaw_of(ego.qx, ego.qy, ego.qz, ego.qw) - own))
    return p.enable_deviation_checks and not (
        t.trans_dev <= p.emergency_state_traj_trans_dev
        and t.rot_dev <= p.emergency_state_traj_rot_dev
    )


@kernel
def set_stop_distance(p, u, s, work):
    """Distance [m] to the stop point, from the ego or from its projection; 0 when not finite.

    From the ego itself it goes on below zero beyond the end of the trajectory.
    """
    if p.stop_distance_from_ego:
        segment = segment_of(work, s.n, find_pose(p, work, s.n, u), u.x, u.y)
        ahead = offset_along(work, segment, u.x, u.y)
        s.stop_dist = stop_distance(work, s.n, segment) - ahead
    else:
        s.stop_dist = stop_distance(work, s.n, s.nearest)
    if not math.isfinite(s.stop_dist):
        s.stop_dist = 0.0


@kernel
def _insert_at_time(s, work, time, point):
    """Write the ``point`` that is due at ``time`` [s], insert it; return the index before it.

    Before the first point the first counts, after the last the last, which is then appended.
    """
    segment = 0
    if time <= s.times[0]:
        interpolate_point(work[0], work[0], 0.0, point)
        time = s.times[0]
    elif time >= s.times[s.n - 1]:
        segment = s.n - 1
        interpolate_point(work[segment], work[segment], 0.0, point)
        time = s.times[segment]
    else:
        while s.times[segment + 1] < time:
            segment += 1
        duration = max(s.times[segment + 1] - s.times[segment], SHORTEST)
        part = (time - s.times[segment]) / duration
        interpolate_point(work[segment], work[segment + 1], part, point)
    for i in range(s.n, segment + 1, -1):
        s.times[i] = s.times[i - 1]
    s.times[segment + 1] = whole_nanoseconds(time)
    s.n = insert_plainly(work, s.n, segment + 1, point)
    return segment


@kernel
def _locate_ego_by_time(u, s, points, work, now):
    """Copy the trajectory into the list, and insert where the vehicle should be now."""
    s.n = u.n_points
    if s.n < 2:
        return -1
    for i in range(s.n):
        work[i] = points[i]
        s.times[i] = time_of(points, i, u.trajectory_start)
    return _insert_at_time(s, work, now - u.trajectory_stamp, s.ego_point)


@kernel
def _locate_target_by_time(p, s, work, segment):
    """Insert the point that is due after the delay, and find both in the list."""
    s.nearest = segment + 1
    due = s.times[s.nearest] + p.delay_compensation_time
    s.target = _insert_at_time(s, work, due, s.target_point) + 1


@kernel
def locate_ego(p, u, s, points, work, now):
    """Copy the trajectory into the list with the ego's point in it; return the ego's segment.

    -1 when fewer than two distinct points are left.
    """
    if p.trajectory_reference_mode == TEMPORAL:
        return _locate_ego_by_time(u, s, points, work, now)
    s.n = copy_distinct(points, u.n_points, work)
    if s.n < 2:
        return -1
    return insert_projection(p, s, work, u, s.ego_point)


@kernel
def locate_target(p, u, s, work, segment, now):
    """Insert the point that the ego reaches during the delay, and find both in the list.

    The walk starts at the index that the ego's point was given, even where it was left out because
    it stands on the point before.
    """
    predict_after_delay(p, u, s, now)
    if p.trajectory_reference_mode == TEMPORAL:
        _locate_target_by_time(p, s, work, segment)
        return
    moves = s.pred_dist > MIN_RUN
    if moves:
        pose_ahead(work, s.n, segment + 1, s.pred_dist, s.target_point)
        insert_projection(p, s, work, s.target_point, s.target_point)
    s.nearest = find_pose(p, work, s.n, s.ego_point)
    s.target = find_pose(p, work, s.n, s.target_point) if moves else s.nearest


@kernel
def update_gear(s, work):
    """Take the gear from the target speed; a change resets the PID."""
    speed = np.float64(work[s.target].v)
    if abs(speed) > GEAR_SPEED and s.gear_forward != (speed > 0.0):
        s.gear_forward = speed > 0.0
        pid_reset(s.pid)
