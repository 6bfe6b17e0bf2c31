# SPDX-License-Identifier: Apache-2.0
"""What no input may do to the follower: touch its memory, stop it, make it grow."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.limits import MAX_HISTORY
from safety_island.control.status import Refusal
from safety_island.kernel.kernel import JIT
from tests.control.follower_rig import driving, finite, memory
from tests.control.hostile import Offer, cases
from tests.control.lateral_rig import PERIOD, START, line
from tests.golden.harness import firmware, parameters_of, played, recorded

CASES = dict(cases())


@pytest.fixture(scope="module")
def both() -> tuple[TrajectoryFollower, ...]:
    return driving(), TrajectoryFollower(firmware())


@pytest.mark.parametrize("offer", CASES.values(), ids=list(CASES))
def test_a_refused_input_leaves_everything_as_it_was(
    both: tuple[TrajectoryFollower, ...], offer: Offer
) -> None:
    """Of a follower that drives, and of one that has no input yet."""
    for follower in both:
        before = memory(follower)
        assert offer(follower) is not Refusal.ACCEPTED
        assert memory(follower) == before


@pytest.mark.parametrize(
    ("name", "ticks"),
    [
        ("s_curve/ctrl0.15_unconstraint_fast_alt", 30),
        ("reverse/ctrl0.15_unconstraint_fast_nodelay", 30),
        ("u_turn/ctrl0.15_osqp", 12),
    ],
)
def test_the_next_good_input_gives_what_it_would_have_given(name: str, ticks: int) -> None:
    """A run with every hostile input between any two good ones, beside the run alone."""
    run = recorded(name)
    disturbed, twin = (TrajectoryFollower(parameters_of(run)) for _ in range(2))
    pairs = zip(played(run, disturbed), played(run, twin), strict=True)
    for (tick, now), _ in pairs:
        for offer in CASES.values():
            assert offer(disturbed) is not Refusal.ACCEPTED
        assert disturbed.step(now) and twin.step(now)
        assert memory(disturbed) == memory(twin)
        if tick >= ticks:
            break


def test_random_bytes_do_no_harm() -> None:
    """Whatever a decoder lets through: refused, or followed without a number that is none."""
    rng = np.random.default_rng(11)
    follower = driving()
    accepted = 0
    for i in range(400):
        n = int(rng.choice([2, 3, 10, 60]))
        follower.incoming[:n] = line(59.0)[:n]
        raw = follower.incoming[:n].view(np.uint8)
        for _ in range(int(rng.integers(1, 4))):
            raw[int(rng.integers(len(raw)))] ^= np.uint8(1 << int(rng.integers(8)))
        accepted += follower.offer_incoming(n, START) is Refusal.ACCEPTED
        follower.step(START + 1.0 + i * PERIOD)
        assert finite(follower)
    assert 100 < accepted < 400


@pytest.mark.skipif(not JIT, reason="takes minutes in plain Python")
@pytest.mark.parametrize("solver", ["unconstraint_fast", "daqp"])
def test_nothing_grows_while_the_planner_stands_still(solver: str) -> None:
    """Three thousand ticks on one trajectory, as when the planner has died."""
    follower = driving(qp_solver_type=solver)
    tracemalloc.start()
    try:
        for i in range(3000):
            if i == 500:
                settled = tracemalloc.get_traced_memory()[0]
            follower.offer_odometry(5.0, 0.1, 0.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.0)
            assert follower.step(START + 1.0 + i * PERIOD)
        assert tracemalloc.get_traced_memory()[0] - settled < 1024
    finally:
        tracemalloc.stop()
    lat = follower._lateral[0]
    assert lat.ends_n == 1 and lat.history_n < 12 and lat.predictor_n < 6
    assert follower._longitudinal[0].commands_n <= MAX_HISTORY
