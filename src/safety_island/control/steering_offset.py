# SPDX-License-Identifier: Apache-2.0
"""A constant offset of the steering sensor (optional): estimated, or taken from a topic."""

import math

from safety_island.control.filters import butterworth
from safety_island.control.geometry import clip
from safety_island.control.limits import MAX_OFFSET_SAMPLES
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.inverse import atan2

_ARRIVED = 1e-4
"""Distance [rad] from its target at which the filtered offset counts as there."""


@kernel
def follow_offset(params, lat, offset):
    """Follow an offset [rad] that a topic tells, in limited and filtered steps.

    ``lat.offset`` is added to the measured angle and taken from the command, so that the MPC works
    in true angles. Autoware since 0.51: SteeringOffsetEstimator's successor in the lateral
    controller.
    """
    if not params.steering_offset_enable_auto_steering_offset_removal:
        lat.offset_target = 0.0
        lat.offset = 0.0
        return
    step = params.steering_offset_max_update_th
    if abs(lat.offset_target - lat.offset) <= _ARRIVED:
        lat.offset_target += clip(offset - lat.offset_target, -step, step)
    cutoff = params.steering_offset_steer_offset_filter_cutoff_hz
    lat.offset = butterworth(lat.offset_filter, lat.offset_target, cutoff, params.ctrl_period)


@kernel
def update_offset(params, lat, vx, wz, steer):
    """Learn from one tick: speed [m/s], yaw rate [rad/s] and the raw measured angle [rad].

    The expected angle is atan(wz L / vx), whatever the size of vx. The firmware takes
    atan2(wz L, vx), which is the same forward and +-pi in reverse. The storage starts full of
    zeros, so the estimate grows slowly.
    """
    if abs(vx) <= params.steering_offset_update_vel_threshold or vx == 0.0:
        return
    if abs(steer) >= params.steering_offset_update_steer_threshold:
        return
    count = min(max(params.steering_offset_average_num, 1), MAX_OFFSET_SAMPLES)
    sample = float(steer) - atan2(math.copysign(1.0, vx) * wz * params.wheel_base, abs(vx))
    head = lat.offset_head % count
    lat.offset_sum += sample - lat.offset_samples[head]
    lat.offset_samples[head] = sample
    lat.offset_head = (head + 1) % count
    limit = params.steering_offset_steering_offset_limit
    lat.offset = clip(lat.offset_sum / count, -limit, limit)
