# SPDX-License-Identifier: Apache-2.0
"""How far the clock that stamps an input is from the island's wall clock."""

from __future__ import annotations


def clock_gap_s(stamp_ns: int, wall_ns: int, age_s: float) -> float:
    """Return what two clocks differ by at least [s]; below zero when nothing tells them apart.

    A sample was received at most ``age_s`` [s] ago, and made before that: its stamp lies between
    then and now on the island's wall clock, or further back by the time that it was under way.
    """
    since_s = (wall_ns - stamp_ns) / 1e9
    return max(since_s - age_s, -since_s)
