# SPDX-License-Identifier: Apache-2.0
"""Smooth stop: how to brake over the last half metre without a jerk."""

from safety_island.control.geometry import clip, time_since
from safety_island.control.status import SmoothStopMode
from safety_island.kernel.kernel import kernel

STRONG = int(SmoothStopMode.STRONG)
WEAK = int(SmoothStopMode.WEAK)
WEAK_STOP = int(SmoothStopMode.WEAK_STOP)
STRONG_STOP = int(SmoothStopMode.STRONG_STOP)

EPSILON = 2.220446049250313e-16
WEAK_HOLD = 0.5
"""How long weak braking lasts after the vehicle has come to rest [s]."""


@kernel
def smooth_stop_start(p, s, pred_vel, pred_stop_dist, now):
    """Choose the strong braking that would just reach the stop point; start the weak timer."""
    s.weak_time = now
    if pred_stop_dist < EPSILON:
        s.strong_acc = p.smooth_stop_min_strong_acc
        return
    needed = -pred_vel * pred_vel / (2.0 * pred_stop_dist)
    s.strong_acc = clip(needed, p.smooth_stop_min_strong_acc, p.smooth_stop_max_strong_acc)


@kernel
def time_to_stop(s, now):
    """Time [s] until the line through the speed history reaches zero; 0 when there is no estimate.

    Least squares of v = a t + b with t counted from ``now``.
    """
    n = s.speeds_n
    mean_t = 0.0
    mean_v = 0.0
    sum_tv = 0.0
    sum_tt = 0.0
    for i in range(n):
        t = s.speeds_t[i] - now
        v = s.speeds_v[i]
        mean_t += t / n
        mean_v += v / n
        sum_tv += t * v
        sum_tt += t * t
    spread = n * mean_t * mean_t - sum_tt
    if abs(spread) < EPSILON:
        return 0.0
    a = (n * mean_t * mean_v - sum_tv) / spread
    if abs(a) < EPSILON:
        return 0.0
    return max(-(mean_v - a * mean_t) / a, 0.0)


@kernel
def smooth_stop_mode(p, s, v, ax, now):
    """SmoothStopMode for this tick; renews the weak timer while braking weakly in motion."""
    if s.stop_dist < p.smooth_stop_strong_stop_dist:
        return STRONG_STOP
    if s.stop_dist < p.smooth_stop_weak_stop_dist:
        return WEAK_STOP
    running = abs(v) > p.smooth_stop_min_running_vel or abs(ax) > p.smooth_stop_min_running_acc
    if running:
        remaining = time_to_stop(s, now)
        if remaining > p.smooth_stop_weak_stop_time + p.delay_compensation_time:
            return STRONG
        if remaining == 0.0 and abs(v) > p.smooth_stop_max_fast_vel:
            return STRONG
        s.weak_time = now
        return WEAK
    return WEAK if time_since(p, now, s.weak_time) < WEAK_HOLD else STRONG_STOP


@kernel
def smooth_stop_acc(p, s, mode):
    """Acceleration [m/s^2] of a SmoothStopMode."""
    if mode == STRONG:
        return s.strong_acc
    if mode == WEAK:
        return p.smooth_stop_weak_acc
    if mode == WEAK_STOP:
        return p.smooth_stop_weak_stop_acc
    return p.smooth_stop_strong_stop_acc
