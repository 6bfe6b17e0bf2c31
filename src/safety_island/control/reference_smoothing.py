# SPDX-License-Identifier: Apache-2.0
"""Moving average over the reference path (optional)."""

from safety_island.kernel.kernel import kernel


@kernel
def moving_average(values, work, n, reach):
    """Replace each value by the mean over +-reach points, fewer near the ends.

    Each sum runs over its window from the first point on, so that a window of zeros gives exactly
    zero: the sign of a speed decides the model. Returns False, with the values untouched, when
    there are fewer values than ``reach``.
    """
    if n < reach:
        return False
    for i in range(n):
        span = min(reach, i, n - 1 - i)
        if span < reach:
            work[i] = _mean(values[i - span : i + span + 1])
    if n > 2 * reach:
        _full_windows(values[0:n], work[reach : n - reach], 2 * reach + 1)
    for i in range(n):
        values[i] = work[i]
    return True


@kernel
def _mean(values):
    total = 0.0
    for value in values:
        total += value
    return total / values.size


@kernel
def _full_windows(values, means, width):
    """Set ``means[i]`` to the mean of ``values[i : i + width]``, all windows side by side."""
    count = means.size
    for i in range(count):
        means[i] = 0.0
    for j in range(width):
        shifted = values[j : j + count]
        for i in range(count):
            means[i] += shifted[i]
    for i in range(count):
        means[i] /= width


@kernel
def smooth_reference(lat, n, reach):
    """Smooth x, y and speed of the reference; yaw is computed from x and y later."""
    moving_average(lat.rx, lat.smooth, n, reach)
    moving_average(lat.ry, lat.smooth, n, reach)
    moving_average(lat.rv, lat.smooth, n, reach)
