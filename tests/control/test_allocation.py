# SPDX-License-Identifier: Apache-2.0
"""A tick makes no array: not for its inputs, not in the controllers, not for its command."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable

import numpy as np
import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.status import Mode, Refusal
from safety_island.kernel.kernel import JIT
from safety_island.params import from_mapping
from tests.golden.harness import recorded

LIMIT = 512
"""Bytes at a time. Calls take some 250 for their numbers and tuples; an array takes 112 more for
itself, and one of the horizon's fifty doubles another 400."""

Tick = Callable[[int], None]

pytestmark = pytest.mark.skipif(not JIT, reason="plain Python reads a record through new objects")


def ticks_of(solver: str) -> tuple[Tick, Tick]:
    """One whole tick of the benchmark run, and the decoder's part that comes before it."""
    run = recorded("bench/ctrl0.15_unconstraint_fast")
    follower = TrajectoryFollower(
        from_mapping(run.overrides | {"qp_solver_type": solver}, "firmware")
    )
    follower.offer_operation_mode(Mode.AUTONOMOUS, True)
    trajectories = [run.trajectory(tick) for tick in range(200)]
    names = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "wz")
    rows = [[float(run.state[name][tick]) for name in names] for tick in range(200)]
    now, steer, ax = ([float(v) for v in run.state[name]] for name in ("t", "steer", "ax"))
    stamps = [float(stamp) for stamp in run.traj_select[:, 3]]

    def decode(k: int) -> None:
        follower.incoming[: len(trajectories[k])] = trajectories[k]

    def tick(k: int) -> None:
        assert follower.offer_incoming(len(trajectories[k]), stamps[k]) is Refusal.ACCEPTED
        assert follower.offer_odometry(*rows[k]) is Refusal.ACCEPTED
        assert follower.offer_steering(steer[k]) is Refusal.ACCEPTED
        assert follower.offer_acceleration(ax[k]) is Refusal.ACCEPTED
        assert follower.step(now[k])

    return tick, decode


def measured(action: Callable[[int], object], k: int) -> tuple[int, int]:
    """Bytes that an action takes at a time, and those that were in use before it."""
    before = tracemalloc.get_traced_memory()[0]
    tracemalloc.reset_peak()
    action(k)
    return tracemalloc.get_traced_memory()[1] - before, before


@pytest.mark.parametrize("solver", ["unconstraint_fast", "daqp"])
def test_a_tick_makes_no_array(solver: str) -> None:
    tick, decode = ticks_of(solver)
    taken, in_use = np.zeros(150), np.zeros(150)
    tracemalloc.start()
    try:
        for k in range(150):
            decode(k)
            taken[k], in_use[k] = measured(tick, k)
    finally:
        tracemalloc.stop()
    assert taken[50:].max() <= LIMIT, taken
    assert in_use[-1] - in_use[50] <= LIMIT, in_use


def test_an_array_would_be_seen() -> None:
    """What is measured tells a tick with one array of the horizon from one without."""
    tracemalloc.start()
    try:
        taken, _ = measured(lambda n: np.empty(n).fill(0.0), 50)
    finally:
        tracemalloc.stop()
    assert taken >= LIMIT - 250
