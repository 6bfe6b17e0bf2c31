# SPDX-License-Identifier: Apache-2.0
"""What two clocks differ by at least, when a sample was received at some time of an interval."""

from __future__ import annotations

import pytest

from safety_island.input_gate.clock_gap import clock_gap_s

NOW_NS = 1_700_000_000_000_000_000


@pytest.mark.parametrize(
    ("back_s", "age_s", "gap_s"),
    [
        (0.0, 0.0, 0.0),
        (0.25, 0.25, 0.0),  # made when it was received, by the same clock
        (0.125, 0.25, -0.125),  # within the interval: nothing tells the clocks apart
        (1.0, 0.25, 0.75),  # behind
        (-0.5, 0.25, 0.5),  # from the future: ahead, whatever the age
    ],
)
def test_what_lies_outside_the_interval_counts(back_s: float, age_s: float, gap_s: float) -> None:
    assert clock_gap_s(NOW_NS - int(back_s * 1e9), NOW_NS, age_s) == gap_s
