# SPDX-License-Identifier: Apache-2.0
"""Cleaning of a received trajectory: flaws of its points that its path has not.

The check of a trajectory (``input_check``) asks for it; a trajectory without such flaws never comes
here, so none of its bits change. Points are compared with the path over distances beyond noise:

- a point on top of the one before goes, as in Autoware's ``removeOverlapPoints``;
- an orientation that contradicts the path on both sides is replaced by the path's direction;
- a point within noise of the one before goes when it does not lie ahead of it: splines through two
  points some millimetres apart swing metres far.

Of two points that become one the slower speed counts, so no stop point is lost. Stop points that
are all at one place give no path; they tell a vehicle that stands to stay there, as planners do.
"""

import math

from safety_island.control.geometry import normalize_angle, yaw_of
from safety_island.control.input_check import (
    FEWEST_POINTS,
    NEAR,
    STANDSTILL,
    has_room,
    leads_both_ways,
    leans,
)
from safety_island.control.point_list import between, interpolate_pose, overlaps
from safety_island.control.points import advance, distance_2d
from safety_island.control.records import CLEANED, INPUTS, PARAMS, POINT
from safety_island.control.status import Refusal
from safety_island.kernel.kernel import entry, kernel
from safety_island.kernel.math.inverse import atan2
from safety_island.kernel.math.trigonometric import cos, sin

REACH = 0.1
"""Distance [m] over which the path has a direction, whatever the noise of its points."""
AT_REST = 0.1
"""Speed [m/s] below which the vehicle stands."""
STAND_LENGTH = 1.0
"""Length [m] ahead of and behind the place where a standing vehicle is to stay.

The longitudinal controller takes 1.5 m behind a stop point for an emergency.
"""
MAX_YAW_OFF = 0.5
"""Angle [rad] between a point's orientation and the path on either side, beyond which it is wrong.

The longitudinal controller brakes hard from 0.785 rad between vehicle and trajectory on.
"""

_ACCEPTED = int(Refusal.ACCEPTED)
_TOO_LONG = int(Refusal.TOO_LONG)
_COINCIDENT = int(Refusal.COINCIDENT_POINTS)
_MIXED = int(Refusal.MIXED_DIRECTION)


@kernel
def _merge(kept, other):
    """Drop a point in favour of the one before: the slower speed counts, with its acceleration.

    Of equal speeds the later acceleration counts, which is the one that leads on.
    """
    if abs(other.v) <= abs(kept.v):
        kept.v = other.v
        kept.acc = other.acc


@kernel
def _drop_coincident(points, n):
    """Leave one of all points in a row that are at one place; return how many are left."""
    count = 1
    for i in range(1, n):
        if overlaps(points[i], points[count - 1]):
            _merge(points[count - 1], points[i])
        else:
            if count < i:
                points[count] = points[i]
            count += 1
    return count


@kernel
def _direction(a, b):
    """Direction [rad] from one point to another."""
    return atan2(b.y - a.y, b.x - a.x)


@kernel
def _turn_to(point, yaw):
    """Turn an orientation about the vertical to a yaw [rad]; pitch and roll stay."""
    half = 0.5 * (yaw - yaw_of(point.qx, point.qy, point.qz, point.qw))
    c = cos(half)
    s = sin(half)
    qx = point.qx
    qz = point.qz
    point.qx = c * qx - s * point.qy
    point.qy = c * point.qy + s * qx
    point.qz = c * qz + s * point.qw
    point.qw = c * point.qw - s * qz


@kernel
def _compare_yaws(points, n, turned):
    """Count the orientations that contradict the path: driven forward, and driven backward.

    An orientation is right when it lies between the directions before and behind its point, or at
    most MAX_YAW_OFF beside them. Both counts are -1 when the path turns by more than a right angle
    in one point: nobody can say which side is wrong there. ``turned`` is ``yaw - direction`` [rad]
    of the points to be put right (0 or pi), NaN for none.
    """
    forward = 0
    backward = 0
    behind = 0
    ahead = 0
    for i in range(n):
        while behind + 1 < i and distance_2d(points[behind + 1], points[i]) >= REACH:
            behind += 1
        ahead = max(ahead, i + 1)
        while ahead < n - 1 and distance_2d(points[i], points[ahead]) < REACH:
            ahead += 1
        comes = behind < i and distance_2d(points[behind], points[i]) >= REACH
        goes = ahead < n and distance_2d(points[i], points[ahead]) >= REACH
        if not comes and not goes:
            continue
        before = _direction(points[behind], points[i]) if comes else 0.0
        after = _direction(points[i], points[ahead]) if goes else before
        bend = normalize_angle(after - before) if comes else 0.0
        if abs(bend) > 0.5 * math.pi:
            return -1, -1
        middle = after - 0.5 * bend
        point = points[i]
        off = normalize_angle(yaw_of(point.qx, point.qy, point.qz, point.qw) - middle)
        allowed = 0.5 * abs(bend) + MAX_YAW_OFF
        forward += abs(off) > allowed
        backward += abs(normalize_angle(off - math.pi)) > allowed
        if abs(normalize_angle(off - turned)) > allowed:  # never for NaN
            _turn_to(point, middle + turned)
    return forward, backward


@kernel
def _straighten(points, n):
    """Replace the orientations that contradict the path, if they are the lesser part.

    Returns how many they were, and the driving direction: whether most points face backward.
    """
    forward, backward = _compare_yaws(points, n, math.nan)
    is_backward = backward < forward
    wrong = min(forward, backward)
    if wrong <= 0 or 2 * wrong >= n:
        return 0, is_backward
    _compare_yaws(points, n, math.pi if is_backward else 0.0)
    return wrong, is_backward


@kernel
def _drop_noise(points, n, is_backward):
    """Drop points within noise of the one before that do not lie ahead of it; return the rest."""
    count = 1
    for i in range(1, n):
        kept = points[count - 1]
        dx = points[i].x - kept.x
        dy = points[i].y - kept.y
        if dx * dx + dy * dy < NEAR * NEAR:
            way, side = advance(kept, dx, dy)
            if leans(dx, dy, way, side) or (way < 0.0) != is_backward:
                _merge(kept, points[i])
                continue
        if count < i:
            points[count] = points[i]
        count += 1
    return count


@kernel
def _add_middle(points):
    """Put a point between the only two, so that both controllers can follow them."""
    points[2] = points[1]
    a = points[0]
    b = points[2]
    middle = points[1]
    interpolate_pose(a, b, 0.5, middle)
    middle.v = between(a.v, b.v, 0.5)
    middle.acc = between(a.acc, b.acc, 0.5)


@kernel
def _extent(points, n):
    """Greatest distance [m] of a point from the first."""
    greatest = 0.0
    for i in range(1, n):
        greatest = max(greatest, distance_2d(points[0], points[i]))
    return greatest


@kernel
def _are_stop_points(points, n):
    """Whether no point of a trajectory moves the vehicle."""
    fastest = 0.0
    for i in range(n):
        fastest = max(fastest, abs(points[i].v))
    return n >= FEWEST_POINTS and fastest < STANDSTILL


@kernel
def _stands_at(params, point, inputs):
    """Whether the vehicle stands, and near enough to a place to stay there."""
    yaw = yaw_of(inputs.qx, inputs.qy, inputs.qz, inputs.qw)
    off = normalize_angle(yaw_of(point.qx, point.qy, point.qz, point.qw) - yaw)
    return (
        abs(inputs.vx) < AT_REST
        and distance_2d(point, inputs) <= params.emergency_state_traj_trans_dev
        and abs(off) <= params.emergency_state_traj_rot_dev
    )


@kernel
def _stretch(points):
    """Make a path of three stop points out of the first, along its orientation."""
    points[1] = points[0]
    points[2] = points[0]
    middle = points[1]
    dx = STAND_LENGTH * (1.0 - 2.0 * (middle.qy * middle.qy + middle.qz * middle.qz))
    dy = STAND_LENGTH * 2.0 * (middle.qx * middle.qy + middle.qw * middle.qz)
    dz = STAND_LENGTH * 2.0 * (middle.qx * middle.qz - middle.qw * middle.qy)
    points[0].x -= dx
    points[0].y -= dy
    points[0].z -= dz
    points[2].x += dx
    points[2].y += dy
    points[2].z += dz


@entry(PARAMS, POINT, INPUTS, CLEANED, int)
def clean_trajectory(params, points, inputs, cleaned, n):
    """Clean ``points[:n]``, of which ``check_trajectory`` said NEEDS_CLEANING; a Refusal.

    ``cleaned`` says how many points are left, and how many orientations were replaced. ``inputs``
    tell whether the vehicle stands there: then stop points at one place become a short path.
    """
    are_stops = _are_stop_points(points, n)
    left = _drop_coincident(points, n)
    wrong, is_backward = _straighten(points, left)
    left = _drop_noise(points, left, is_backward)
    cleaned[0].turned = wrong
    cleaned[0].n = left
    if _extent(points, left) < REACH:
        if not (are_stops and _stands_at(params[0], points[0], inputs[0])):
            return _COINCIDENT
        _stretch(points)
        cleaned[0].n = FEWEST_POINTS
        return _ACCEPTED
    if left < FEWEST_POINTS <= n:
        _add_middle(points)
        left = FEWEST_POINTS
    cleaned[0].n = left
    if not has_room(params, points, left):
        return _TOO_LONG
    return _MIXED if leads_both_ways(points, left) else _ACCEPTED
