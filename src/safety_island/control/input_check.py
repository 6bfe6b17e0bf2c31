# SPDX-License-Identifier: Apache-2.0
"""Refusal of inputs that must not touch the controllers: every value finite and within reason.

The bounds are wide: they keep squares and sums of finite numbers finite, nothing more. A trajectory
is checked here and, where its points have flaws that its path has not, cleaned in
``trajectory_clean``.
"""

import math

import numpy as np

from safety_island.control.limits import EXTENSION_POINTS, MAX_POINTS, MAX_REFERENCE
from safety_island.control.points import advance, time_of
from safety_island.control.records import PARAMS, POINT
from safety_island.control.status import ReferenceMode, Refusal
from safety_island.kernel.kernel import entry, kernel

MAX_POSITION = 1e7
"""[m]; a UTM northing stays below it."""
MAX_SPEED = 150.0
"""[m/s]; no road vehicle of series reaches it."""
MAX_ACCELERATION = 100.0
"""[m/s^2]; ten times what tyres can do, as only a collision does."""
MAX_TURN = 100.0
"""Angles [rad] and turn rates [rad/s]; sixteen turns, or turns a second, as no vehicle does."""
MIN_SQUARE_NORM = 0.99**2
MAX_SQUARE_NORM = 1.01**2
"""The norm of an orientation may be 1 % off: single precision and averaging leave far less."""

MAX_BACKTRACK = 0.05
"""Length [m] that a trajectory may lead against the direction of the rest of it."""
STANDSTILL = 1e-3
"""Speed [m/s] below which a point has no direction."""
NEAR = 0.03
"""Two points nearer than this [m] give no direction: ten times the noise of a planner's points."""
UNIT_TOLERANCE = 1e-9
"""Square of a norm further than this from 1 is brought back to it; nearer, the bits stay."""

_ACCEPTED = int(Refusal.ACCEPTED)
_NOT_FINITE = int(Refusal.NOT_FINITE)
_TOO_FEW = int(Refusal.TOO_FEW_POINTS)
_TOO_MANY = int(Refusal.TOO_MANY_POINTS)
_BAD_QUATERNION = int(Refusal.BAD_QUATERNION)
_TOO_LONG = int(Refusal.TOO_LONG)
_OUT_OF_RANGE = int(Refusal.OUT_OF_RANGE)
_MIXED = int(Refusal.MIXED_DIRECTION)
_NEEDS_CLEANING = int(Refusal.NEEDS_CLEANING)
_BAD_TIMES = int(Refusal.BAD_TIMES)
_TEMPORAL = int(ReferenceMode.TEMPORAL)

_LARGEST_PART = 2.0  # of a quaternion; the square of a larger one could overflow
_LARGEST_SUM = 2.5  # of the magnitudes of its parts; 2 at most for a unit
_FEWEST_POINTS = 2
FEWEST_POINTS = 3
"""Points with which both controllers run; two are enough for the longitudinal one."""
_LEANS = 0.5
"""Tangent of the angle between step and orientation, beyond which it is looked at closely."""
_LEANS_NEAR = 0.05
"""The same for points that are NEAR, where the flaws of splines begin."""


@kernel
def _normalise(point, square):
    """Bring an orientation with this square of its norm to the norm 1."""
    scale = 1.0 / math.sqrt(square)
    point.qx *= scale
    point.qy *= scale
    point.qz *= scale
    point.qw *= scale


@kernel
def leans(dx, dy, way, side):
    """Whether a step leads so far aside of an orientation, or so short, that one may be wrong."""
    limit = _LEANS_NEAR if abs(dx) + abs(dy) < NEAR else _LEANS
    return not abs(side) < limit * abs(way)


@kernel
def _check_point(point):
    """Refusal of one trajectory point, the first reason found; its orientation becomes a unit.

    Where sums of magnitudes keep the bounds, every number does, and none is NaN. That is nearly
    every point; what is wrong with another one is looked for value by value.
    """
    place = abs(point.x) + abs(point.y) + abs(point.z)
    speed = np.float64(abs(point.v)) + abs(point.v_lat)  # a sum in single precision may overflow
    turn = np.float64(abs(point.heading_rate)) + abs(point.front_wheel) + abs(point.rear_wheel)
    parts = abs(point.qx) + abs(point.qy) + abs(point.qz) + abs(point.qw)
    if (
        place <= MAX_POSITION
        and speed <= MAX_SPEED
        and turn <= MAX_TURN
        and abs(point.acc) <= MAX_ACCELERATION
        and parts <= _LARGEST_SUM
        and abs(_square_norm(point) - 1.0) <= UNIT_TOLERANCE
    ):
        return _ACCEPTED
    return _check_values(point)


@kernel
def _square_norm(point):
    """Square of the norm of an orientation."""
    square = point.qx * point.qx + point.qy * point.qy
    return square + (point.qz * point.qz + point.qw * point.qw)


@kernel
def _check_values(point):
    """The same, value by value."""
    place = max(abs(point.x), abs(point.y), abs(point.z))
    speed = max(abs(point.v), abs(point.v_lat))
    turn = max(abs(point.heading_rate), abs(point.front_wheel), abs(point.rear_wheel))
    # a sum finds the NaN that max may hide
    total = point.x + point.y + point.z + point.v + point.v_lat + point.acc
    total += point.heading_rate + point.front_wheel + point.rear_wheel
    if not math.isfinite(total):
        return _NOT_FINITE
    in_range = place <= MAX_POSITION and speed <= MAX_SPEED and turn <= MAX_TURN
    if not in_range or abs(point.acc) > MAX_ACCELERATION:
        return _OUT_OF_RANGE
    if max(abs(point.qx), abs(point.qy), abs(point.qz), abs(point.qw)) <= _LARGEST_PART:
        square = _square_norm(point)
        if MIN_SQUARE_NORM <= square <= MAX_SQUARE_NORM:
            if abs(square - 1.0) > UNIT_TOLERANCE:
                _normalise(point, square)
            return _ACCEPTED
    parts = point.qx + point.qy + point.qz + point.qw
    return _BAD_QUATERNION if math.isfinite(parts) else _NOT_FINITE


@kernel
def _length(points, n):
    """The 2-D length of a trajectory [m]."""
    total = 0.0
    for i in range(1, n):
        dx = points[i].x - points[i - 1].x
        dy = points[i].y - points[i - 1].y
        total += math.sqrt(dx * dx + dy * dy)
    return total


@kernel
def has_room(params, points, n):
    """Whether the resampled trajectory fits its memory."""
    room = (MAX_REFERENCE - EXTENSION_POINTS) * params[0].traj_resample_dist
    return _length(points, n) <= room


@kernel
def _checked_length(params, points, n, bound):
    """TOO_LONG where the resampled trajectory does not fit; ``bound`` [m]: at least its length."""
    room = (MAX_REFERENCE - EXTENSION_POINTS) * params[0].traj_resample_dist
    return _TOO_LONG if bound > room and not has_room(params, points, n) else _ACCEPTED


@kernel
def leads_both_ways(points, n):
    """Whether the points lead to and fro, in steps beyond noise."""
    forward = 0.0
    backward = 0.0
    last = 0
    for i in range(1, n):
        dx = points[i].x - points[last].x
        dy = points[i].y - points[last].y
        if dx * dx + dy * dy >= NEAR * NEAR:
            way, _ = advance(points[last], dx, dy)
            forward += max(way, 0.0)
            backward += max(-way, 0.0)
            last = i
    return min(forward, backward) > MAX_BACKTRACK


@kernel
def _has_ascending_times(points, n, start):
    """Whether each point is due later than the one before."""
    previous = start
    for i in range(1, n):
        time = time_of(points, i, start)
        if not time > previous:
            return False
        previous = time
    return True


@entry(PARAMS, POINT, int, float)
def check_trajectory(params, points, n, start):
    """Refusal of a received trajectory ``points[:n]``; nearly unit orientations become units.

    ``start`` [s] is the time_from_start of the first point. A trajectory leads forward or backward,
    not both, and so do its speeds. NEEDS_CLEANING: every value is fine, and ``clean_trajectory``
    decides; never in the temporal mode, where points may coincide (the vehicle waits there), and
    where times must ascend.
    """
    if n < _FEWEST_POINTS:
        return _TOO_FEW
    if n > MAX_POINTS:
        return _TOO_MANY
    is_timed = params[0].trajectory_reference_mode == _TEMPORAL
    if is_timed and not _has_ascending_times(points, n, start):
        return _BAD_TIMES
    bound = 0.0  # at least the length of the path
    forward = False
    backward = False
    is_clean = True
    fastest = 0.0
    slowest = 0.0
    dx = 0.0
    dy = 0.0
    for i in range(n):
        reason = _check_point(points[i])
        if reason != _ACCEPTED:
            return reason
        fastest = max(fastest, points[i].v)
        slowest = min(slowest, points[i].v)
        if i > 0:
            dx = points[i].x - points[i - 1].x
            dy = points[i].y - points[i - 1].y
            bound += abs(dx) + abs(dy)
            way, side = advance(points[i - 1], dx, dy)
            forward |= way > 0.0
            backward |= way < 0.0
            is_clean &= not leans(dx, dy, way, side)
    if min(fastest, -slowest) > STANDSTILL:
        return _MIXED
    if is_timed:
        is_clean = not leads_both_ways(points, n)
        return _checked_length(params, points, n, bound) if is_clean else _MIXED
    way, side = advance(points[n - 1], dx, dy)
    forward |= way > 0.0
    backward |= way < 0.0
    if not is_clean or leans(dx, dy, way, side) or (forward and backward):
        return _NEEDS_CLEANING
    return _checked_length(params, points, n, bound)
