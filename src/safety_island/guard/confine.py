# SPDX-License-Identifier: Apache-2.0
"""A value and the intervals that it must lie in."""

from __future__ import annotations

from collections.abc import Sequence
from math import copysign

Bounds = tuple[Sequence[int], Sequence[float], Sequence[float]]
"""Intervals, the weakest first: bits of the limits, their lowest and their highest values."""


def confine(value: float, bounds: Bounds) -> tuple[float, int]:
    """Return the value moved into each interval in turn, and the bits of the limits that acted.

    When the intervals have values in common the result is one of them, whatever their order: moving
    a point of one interval to the nearest of another does not leave what they share. When they have
    none in common the last interval holds. A limit acts when it moves the value, or when the value
    as it was proposed breaks it.
    """
    _, lows, highs = bounds
    if max(lows) <= value <= min(highs):
        return value, 0
    return _moved(value, bounds)


def _moved(value: float, bounds: Bounds) -> tuple[float, int]:
    confined, bits = value, 0
    for bit, low, high in zip(*bounds, strict=True):
        if not low <= value <= high or not low <= confined <= high:
            bits |= bit
        confined = min(max(confined, low), high)
    return confined, bits


def within(value: float, limit: float, bit: int) -> tuple[float, int]:
    """Return the value within plus or minus the limit, and the bit when that moved it."""
    if -limit <= value <= limit:
        return value, 0
    return copysign(limit, value), bit


def share(value: float, confined: float, start: float) -> float:
    """Return how much of the way from ``start`` to ``value`` is left, 0 to 1, when it ends early.

    A way that turns round, or never was one, is 0; one that became longer is 1.
    """
    whole = value - start
    if whole == 0.0:
        return 0.0
    return min(max((confined - start) / whole, 0.0), 1.0)
