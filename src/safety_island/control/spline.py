# SPDX-License-Identifier: Apache-2.0
"""Natural cubic splines over the arc length of a trajectory, curves sharing one elimination."""

import math

from safety_island.kernel.kernel import kernel


@kernel
def second_derivatives(arc, gain, values, second, n):
    """Fill the second derivatives of one curve through ``values[:n]``; zero at both ends."""
    second[0] = 0.0
    for i in range(1, n - 1):
        before = arc[i] - arc[i - 1]
        after = arc[i + 1] - arc[i]
        slope = (values[i + 1] - values[i]) / after - (values[i] - values[i - 1]) / before
        # gain[i] / after is one over the pivot
        second[i] = (6.0 * slope - before * second[i - 1]) * gain[i] / after
    second[n - 1] = 0.0
    for i in range(n - 2, 0, -1):
        second[i] -= gain[i] * second[i + 1]


@kernel
def elimination_factors(arc, gain, n):
    """Fill the factors of the elimination that ``second_derivatives`` needs."""
    gain[0] = 0.0
    for i in range(1, n - 1):
        before = arc[i] - arc[i - 1]
        after = arc[i + 1] - arc[i]
        gain[i] = after / (2.0 * (before + after) - before * gain[i - 1])


@kernel
def fit_space_curve(arc, gain, x, y, z, mx, my, mz, n):
    """Fill arc length, elimination factors and second derivatives of a curve through n points.

    One pass forward and one back: the chains of all three curves run side by side.
    """
    last = n - 1
    arc[0] = gain[0] = mx[0] = my[0] = mz[0] = 0.0
    mx[last] = my[last] = mz[last] = 0.0
    before = _step_length(x, y, 0)
    arc[1] = before
    inverse = 1.0 / before
    sx = (x[1] - x[0]) * inverse
    sy = (y[1] - y[0]) * inverse
    sz = (z[1] - z[0]) * inverse
    for i in range(1, last):
        after = _step_length(x, y, i)
        arc[i + 1] = arc[i] + after
        # two divisions, for the next point waits for ``gain`` and not for ``inverse_pivot``
        pivot = 2.0 * (before + after) - before * gain[i - 1]
        gain[i] = after / pivot
        inverse_pivot = 1.0 / pivot
        inverse = 1.0 / after
        tx = (x[i + 1] - x[i]) * inverse
        ty = (y[i + 1] - y[i]) * inverse
        tz = (z[i + 1] - z[i]) * inverse
        mx[i] = (6.0 * (tx - sx) - before * mx[i - 1]) * inverse_pivot
        my[i] = (6.0 * (ty - sy) - before * my[i - 1]) * inverse_pivot
        mz[i] = (6.0 * (tz - sz) - before * mz[i - 1]) * inverse_pivot
        before = after
        sx = tx
        sy = ty
        sz = tz
    for i in range(last - 1, 0, -1):
        mx[i] -= gain[i] * mx[i + 1]
        my[i] -= gain[i] * my[i + 1]
        mz[i] -= gain[i] * mz[i + 1]


@kernel
def _step_length(x, y, i):
    """2-D distance from point i to the next."""
    dx = x[i + 1] - x[i]
    dy = y[i + 1] - y[i]
    return math.sqrt(dx * dx + dy * dy)


@kernel
def spline_value(arc, values, second, j, s):
    """Value at arc length ``s`` by the cubic of interval ``j``."""
    h = arc[j + 1] - arc[j]
    t = s - arc[j]
    a = (second[j + 1] - second[j]) / (6.0 * h)
    b = second[j] / 2.0
    c = (values[j + 1] - values[j]) / h - h * (2.0 * second[j] + second[j + 1]) / 6.0
    return ((a * t + b) * t + c) * t + values[j]


@kernel
def interval_from(arc, n, j, s):
    """Interval that holds ``s``, searched upward from ``j``; the last one when ``s`` is beyond."""
    while j < n - 2 and s > arc[j + 1]:
        j += 1
    return j


@kernel
def unwrap_step(angle, previous):
    """The equal of ``angle`` [rad] that lies nearest to ``previous``."""
    return angle - 2.0 * math.pi * math.floor((angle - previous) / (2.0 * math.pi) + 0.5)
