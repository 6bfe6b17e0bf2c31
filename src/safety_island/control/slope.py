"""Slope of the road: where it is taken from, and the acceleration that compensates it."""

import math

from safety_island.control.geometry import clip
from safety_island.control.kernel import kernel
from safety_island.control.pid import low_pass
from safety_island.control.status import SlopeSource
from safety_island.control.trajectory_walk import pitch_ahead

RAW_PITCH = int(SlopeSource.RAW_PITCH)
TRAJECTORY_PITCH = int(SlopeSource.TRAJECTORY_PITCH)

GRAVITY = 9.81
"""Standard gravity as the firmware rounds it [m/s^2]."""


@kernel
def body_pitch(qx, qy, qz, qw):
    """Pitch [rad] of an orientation, positive when body x points uphill."""
    return math.asin(clip(2.0 * (qx * qz - qw * qy), -1.0, 1.0))


@kernel
def from_trajectory(p, vx):
    """Whether the slope of this tick comes from the trajectory, not from the body."""
    if p.slope_source == RAW_PITCH:
        return False
    return p.slope_source == TRAJECTORY_PITCH or vx > p.adaptive_trajectory_velocity_th


@kernel
def update_slope(p, u, s, points):
    """Advance the pitch filter and set the slope of this tick [rad]."""
    if p.slope_source != TRAJECTORY_PITCH:
        s.pitch = low_pass(s.pitch, p.lpf_pitch_gain, body_pitch(u.qx, u.qy, u.qz, u.qw))
    s.slope = s.pitch
    if from_trajectory(p, u.vx):
        s.slope = pitch_ahead(points, s.n, s.target, p.wheel_base)


@kernel
def slope_acceleration(p, u, s):
    """Acceleration [m/s^2] in the gear's direction that holds the vehicle against the slope.

    The body's pitch is positive when body x points uphill, so it counts against the reverse gear.
    The trajectory's is positive uphill in the direction of travel; the firmware turns that sign in
    reverse all the same, ``correct_reverse_signs`` does not.
    """
    if not p.enable_slope_compensation:
        return 0.0
    pull = GRAVITY * math.sin(clip(s.slope, p.min_pitch_rad, p.max_pitch_rad))
    if s.gear_forward or (p.correct_reverse_signs and from_trajectory(p, u.vx)):
        return pull
    return -pull
