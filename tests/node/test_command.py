# SPDX-License-Identifier: Apache-2.0
"""What keeps a command from being sent."""

from __future__ import annotations

import math

import pytest

from safety_island.node.command import Computed


@pytest.mark.parametrize(
    ("stamp", "other", "side"),
    [
        (5.0, 5.0, ""),
        (5.0, 4.9, "longitudinal"),
        (4.9, 5.0, "lateral"),
        (4.9, 4.9, "lateral"),
        (math.nan, 5.0, "lateral"),
        (5.0, math.nan, "longitudinal"),
    ],
)
def test_a_stamp_that_is_old_or_no_number_is_stale(stamp: float, other: float, side: str) -> None:
    assert Computed(stamp, other, 0.0, 0.0, 0.0, 0.0, True).stale_side(5.0) == side
