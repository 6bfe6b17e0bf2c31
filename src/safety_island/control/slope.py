# SPDX-License-Identifier: Apache-2.0
"""Slope of the road: where it is taken from, and the acceleration that compensates it."""

from safety_island.control.geometry import clip
from safety_island.control.pid import low_pass
from safety_island.control.points import nearest_position, offset_along, segment_of
from safety_island.control.status import SlopeSource
from safety_island.control.trajectory_walk import arc_length, pitch_ahead
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.inverse import asin
from safety_island.kernel.math.trigonometric import sin

TRAJECTORY_PITCH = int(SlopeSource.TRAJECTORY_PITCH)
TRAJECTORY_ADAPTIVE = int(SlopeSource.TRAJECTORY_ADAPTIVE)
TRAJECTORY_GOAL_ADAPTIVE = int(SlopeSource.TRAJECTORY_GOAL_ADAPTIVE)

GRAVITY = 9.81
"""Standard gravity as the firmware rounds it [m/s^2]."""
RATE_GRAVITY = 9.8
"""The same as Autoware rounds it where a jerk becomes the rate of a slope [m/s^2]."""


@kernel
def body_pitch(qx, qy, qz, qw):
    """Pitch [rad] of an orientation, positive when body x points uphill."""
    return asin(clip(2.0 * (qx * qz - qw * qy), -1.0, 1.0))


@kernel
def goal_distance(u, s, points):
    """Length [m] along the list from the ego's projection to its end; the ego's yaw does not count.

    Autoware: calcSignedArcLength(points, position, last).
    """
    nearest = nearest_position(points, s.n, u.x, u.y)
    segment = segment_of(points, s.n, nearest, u.x, u.y)
    return arc_length(points, segment, s.n - 1) - offset_along(points, segment, u.x, u.y)


@kernel
def from_trajectory(p, u, s, points):
    """Whether the slope of this tick comes from the trajectory, not from the body."""
    source = p.slope_source
    if source == TRAJECTORY_ADAPTIVE:
        threshold = p.adaptive_trajectory_velocity_th
        return u.vx >= threshold if p.slope_rate_limited else u.vx > threshold
    if source == TRAJECTORY_GOAL_ADAPTIVE:
        return goal_distance(u, s, points) >= p.wheel_base
    return source == TRAJECTORY_PITCH


@kernel
def update_slope(p, u, s, points):
    """Advance the pitch filter and set the slope of this tick [rad].

    The adaptive sources change over between two pitches, so by rule their slope is limited to the
    rate at which the acceleration may change. Autoware: PidLongitudinalController::getControlData.
    """
    s.pitch = low_pass(s.pitch, p.lpf_pitch_gain, body_pitch(u.qx, u.qy, u.qz, u.qw))
    s.slope = s.pitch
    s.slope_from_trajectory = from_trajectory(p, u, s, points)
    if s.slope_from_trajectory:
        s.slope = pitch_ahead(points, s.n, s.target, p.wheel_base)
        if p.slope_turns_in_reverse and not s.gear_forward:
            s.slope = -s.slope
    adapts = p.slope_source == TRAJECTORY_ADAPTIVE or p.slope_source == TRAJECTORY_GOAL_ADAPTIVE
    if adapts and p.slope_rate_limited and s.slope_started:
        low = p.min_jerk / RATE_GRAVITY
        high = p.max_jerk / RATE_GRAVITY
        s.slope = s.slope_prev + clip(s.slope - s.slope_prev, low * s.dt, high * s.dt)
    s.slope_prev = s.slope
    s.slope_started = True


@kernel
def slope_pull(p, s):
    """Acceleration [m/s^2] by which the slope pulls along body x, within the pitch limits."""
    return GRAVITY * sin(clip(s.slope, p.min_pitch_rad, p.max_pitch_rad))


@kernel
def slope_acceleration(p, s):
    """Acceleration [m/s^2] in the gear's direction that holds the vehicle against the slope.

    The slope counts as positive when body x points uphill, so it counts against the reverse gear.
    Until 0.52 the trajectory's pitch was positive uphill in the direction of travel, and its sign
    was turned in reverse all the same.
    """
    if not p.enable_slope_compensation:
        return 0.0
    return slope_pull(p, s) if s.gear_forward else -slope_pull(p, s)
