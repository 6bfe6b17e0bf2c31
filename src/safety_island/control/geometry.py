# SPDX-License-Identifier: Apache-2.0
"""Angles, clipping and the small scalar formulas that both controllers use."""

import math

import numpy as np

from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.inverse import atan2
from safety_island.kernel.math.remainder import fmod


@kernel
def normalize_angle(angle):
    """Wrap an angle [rad] to [-pi, pi)."""
    wrapped = fmod(angle, 2.0 * math.pi)
    if wrapped >= math.pi or wrapped < -math.pi:
        wrapped -= math.copysign(2.0 * math.pi, wrapped)
    return wrapped


@kernel
def clip(value, low, high):
    """Limit a value to [low, high]; NaN passes."""
    if value < low:
        return low
    if value > high:
        return high
    return value


@kernel
def yaw_of(qx, qy, qz, qw):
    """Yaw [rad] of a quaternion, without normalising it (as the firmware does)."""
    return atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))


@kernel
def time_since(p, now, then):
    """Time [s] from ``then`` to ``now``; by rule as a clock of whole nanoseconds has it."""
    return np.rint((now - then) * 1e9) / 1e9 if p.whole_nanoseconds else now - then


@kernel
def diff_limit(new, previous, dt, low, high):
    """Limit the rate of change from ``previous`` to ``new`` to [low, high] a second."""
    return previous + clip((new - previous) / dt, low, high) * dt


@kernel
def whole_nanoseconds(seconds):
    """Seconds [s] as a stamp holds them: truncated to whole nanoseconds."""
    total = np.int64(seconds * 1e9)
    return total // 1000000000 + (total % 1000000000) * 1e-9
