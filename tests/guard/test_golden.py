# SPDX-License-Identifier: Apache-2.0
"""The guard does not interfere with what the firmware was recorded to do, by limits as shipped."""

from __future__ import annotations

from pathlib import Path

import pytest

from safety_island.core.guard import Guard, Proposal
from safety_island.guard import Limit, Verdict
from safety_island.replay.feed import Replay
from safety_island.replay.recording import load
from tests.golden.harness import name_of, parameters_of, run_paths

COLUMNS = ("steering_tire_angle", "steering_tire_rotation_rate", "velocity", "acceleration")
PUBLISHED_TICKS = 100
"""Ticks of each run that are played through the node; tests/golden plays all of them."""


@pytest.mark.parametrize("path", run_paths(), ids=name_of)
def test_every_recorded_command_passes(path: Path) -> None:
    run = load(path)
    parameters = parameters_of(run)
    guard = Guard(parameters.guard, parameters.vehicle.wheel_base, parameters.node.timeout_thr_sec)
    rows = zip(*(run.output[name].tolist() for name in COLUMNS), strict=True)
    state = zip(*(run.state[name].tolist() for name in ("t", "vx", "steer")), strict=True)
    acted = Limit(0)
    for i, (values, (now, speed, steering)) in enumerate(zip(rows, state, strict=True)):
        if run.output["published"][i]:
            found = guard.check(Proposal(now, now, i, *values), speed, steering)
            acted |= Limit(found.limits)
            assert found.verdict is Verdict.PASSED, (i, Limit(found.limits))
            assert found[2:] == values
    assert not acted


@pytest.mark.parametrize("path", run_paths(), ids=name_of)
def test_what_is_published_is_what_the_controllers_computed(path: Path) -> None:
    """Bit for bit, from the bytes on the topic."""
    run = load(path)
    player = Replay(run)
    for tick in range(min(run.ticks, PUBLISHED_TICKS)):
        published = player.tick(tick)
        if published is not None:
            computed = player.follower.command[0]
            assert [getattr(published, name) for name in COLUMNS] == [computed[n] for n in COLUMNS]
    assert (player.node.check.clamped, player.node.check.refused) == (0, 0)
