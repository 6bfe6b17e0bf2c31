# SPDX-License-Identifier: Apache-2.0
"""Prediction of the present tyre angle from the commands that were sent."""

from safety_island.control.limits import MAX_HISTORY
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.exponential import exp

_TOLERANCE = 1e-9  # seconds; a stamp carries whole nanoseconds


@kernel
def _response_to_commands(lat, start, end, tau):
    """What the commands in force between ``start`` and ``end`` add to the angle."""
    n = lat.predictor_n
    if n <= 2:
        return 0.0
    i = 1
    while start > lat.predictor_t[i] + _TOLERANCE:
        if i + 1 >= n:
            return 0.0
        i += 1
    total = 0.0
    t = start
    while i < n and end > lat.predictor_t[i] + _TOLERANCE:
        step = lat.predictor_t[i] - t
        total += (1.0 - exp(-step / tau)) * float(lat.predictor_u[i - 1])
        t = lat.predictor_t[i]
        i += 1
    return total + (1.0 - exp(-(end - t) / tau)) * float(lat.predictor_u[i - 1])


@kernel
def predict_steering(lat, now, tau):
    """Advance the predicted tyre angle [rad] to ``now`` and return it.

    Nothing passes while ``now`` lies before the last call: undoing the lag would grow without end.
    """
    if not lat.predictor_started:
        lat.predictor_started = True
        lat.predictor_time = now
    start = min(lat.predictor_time, now)
    lat.predictor_time = now
    response = _response_to_commands(lat, start, now, tau)
    lat.predicted = exp(-(now - start) / tau) * lat.predicted + response
    return lat.predicted


@kernel
def store_command(lat, angle, now, delay):
    """Remember a command [rad] that takes effect at ``now + delay``; drop at most one old one."""
    n = lat.predictor_n
    if n == MAX_HISTORY:
        _drop_oldest(lat)
        n -= 1
    lat.predictor_u[n] = angle
    lat.predictor_t[n] = now + delay
    lat.predictor_n = n + 1
    if lat.predictor_n > 2 and now + delay - lat.predictor_t[1] > delay + 0.3:
        _drop_oldest(lat)


@kernel
def _drop_oldest(lat):
    for i in range(1, lat.predictor_n):
        lat.predictor_u[i - 1] = lat.predictor_u[i]
        lat.predictor_t[i - 1] = lat.predictor_t[i]
    lat.predictor_n -= 1
