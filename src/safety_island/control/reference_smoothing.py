"""Moving average over the reference path (optional)."""

from safety_island.control.kernel import kernel


@kernel
def moving_average(values, work, n, reach):
    """Replace each value by the mean over +-reach points, fewer near the ends.

    Returns False, with the values untouched, when there are fewer values than ``reach``.
    """
    if n < reach:
        return False
    base = values[0]  # sums of small numbers lose less
    total = 0.0
    low = 0
    high = 0  # the window is [low, high)
    for i in range(n):
        span = min(reach, i, n - 1 - i)
        while high < i + span + 1:
            total += values[high] - base
            high += 1
        while low < i - span:
            total -= values[low] - base
            low += 1
        work[i] = base + total / (2 * span + 1)
    for i in range(n):
        values[i] = work[i]
    return True


@kernel
def smooth_reference(lat, n, reach):
    """Smooth x, y and speed of the reference; yaw is computed from x and y later."""
    moving_average(lat.rx, lat.smooth, n, reach)
    moving_average(lat.ry, lat.smooth, n, reach)
    moving_average(lat.rv, lat.smooth, n, reach)
