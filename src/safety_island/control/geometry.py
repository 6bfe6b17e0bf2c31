# SPDX-License-Identifier: Apache-2.0
"""Angles, clipping and the small scalar formulas that both controllers use."""

import math

import numpy as np

from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.inverse import atan2
from safety_island.kernel.math.remainder import fmod
from safety_island.kernel.math.trigonometric import cos

_CLEAR = 1e-9
"""Two cosines further apart than this differ by more than rounding."""


@kernel
def normalize_angle(angle):
    """Wrap an angle [rad] to [-pi, pi)."""
    wrapped = fmod(angle, 2.0 * math.pi)
    if wrapped >= math.pi or wrapped < -math.pi:
        wrapped -= math.copysign(2.0 * math.pi, wrapped)
    return wrapped


@kernel
def cosine_of_limit(limit):
    """Cosine of a limit [rad] for ``clear_turn``; below every cosine from half a turn on."""
    return cos(limit) if limit < math.pi else -2.0


@kernel
def clear_turn(x, y, cos_yaw, sin_yaw, cos_limit):
    """Whether the direction (x, y) is turned from a yaw by less than a limit (1), or by more (-1).

    0 where rounding could decide, and for no direction: then the angles themselves must be asked.
    """
    length = math.sqrt(x * x + y * y)
    apart = x * cos_yaw + y * sin_yaw - cos_limit * length
    if apart > _CLEAR * length:
        return 1
    return -1 if apart < -_CLEAR * length else 0


@kernel
def clip(value, low, high):
    """Limit a value to [low, high]; NaN passes."""
    if value < low:
        return low
    if value > high:
        return high
    return value


@kernel
def heading_of(qx, qy, qz, qw):
    """Body x of a quaternion in the plane, without normalising it (as the firmware does)."""
    return 1.0 - 2.0 * (qy * qy + qz * qz), 2.0 * (qw * qz + qx * qy)


@kernel
def yaw_of(qx, qy, qz, qw):
    """Yaw [rad] of a quaternion, by ``heading_of``."""
    x, y = heading_of(qx, qy, qz, qw)
    return atan2(y, x)


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
