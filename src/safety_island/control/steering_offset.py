"""Estimation of a constant offset of the steering sensor (optional)."""

import math

from safety_island.control.geometry import clip
from safety_island.control.kernel import kernel
from safety_island.control.limits import MAX_OFFSET_SAMPLES


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
    sample = float(steer) - math.atan2(math.copysign(1.0, vx) * wz * params.wheel_base, abs(vx))
    head = lat.offset_head % count
    lat.offset_sum += sample - lat.offset_samples[head]
    lat.offset_samples[head] = sample
    lat.offset_head = (head + 1) % count
    limit = params.steering_offset_steering_offset_limit
    lat.offset = clip(lat.offset_sum / count, -limit, limit)
