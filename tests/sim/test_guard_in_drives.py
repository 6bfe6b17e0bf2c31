# SPDX-License-Identifier: Apache-2.0
"""The guard of the set firmware passes whatever its controllers ask for."""

from __future__ import annotations

import pytest

from safety_island.guard import Limit
from tests.sim.random_drives import COLUMNS, is_finite, random_drive

SEEDS = range(30)
DRIVE_S = 30.0


@pytest.mark.parametrize("seed", SEEDS)
def test_the_guard_of_the_set_firmware_never_interferes(seed: int) -> None:
    """Random parameters and disturbances in closed loop; each published command is the computed."""
    follower, loop = random_drive(seed)
    check, ticks, published = follower.node.check, round(DRIVE_S / loop.period_s), 0
    for tick in range(ticks):
        follower.disturb(loop.now)
        loop.tick()
        assert not check.limits, (tick, Limit(check.limits))
        if follower.published is not None:
            published += 1
            computed = follower.follower.command[0]
            assert is_finite(follower.published)
            for name in COLUMNS:
                assert getattr(follower.published, name) == computed[name], (tick, name)
    assert (check.clamped, check.refused) == (0, 0)
    assert published > 0.9 * ticks
