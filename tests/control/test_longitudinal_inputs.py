# SPDX-License-Identifier: Apache-2.0
"""Inputs that are missing, not usable, degenerate or absurd."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from safety_island.control.longitudinal_state import COMMAND_COLUMNS, STATE_COLUMNS
from safety_island.control.status import LongitudinalSkip, LongitudinalState
from tests.control.longitudinal_rig import Rig, cruise

DRIVE, STOPPING, STOPPED, EMERGENCY = LongitudinalState


def untouched(rig: Rig) -> tuple[bytes, bytes]:
    """The memories (not the work values of a tick) and the command."""
    memories = [name for name, *_ in STATE_COLUMNS + COMMAND_COLUMNS]
    return b"".join(rig.state[name].tobytes() for name in memories), rig.command.tobytes()


@pytest.mark.parametrize("n", [0, 1])
def test_without_a_trajectory_the_tick_is_skipped(n: int) -> None:
    rig = cruise(1.0)
    rig.tick(vx=1.0)
    before = untouched(rig)
    rig.inputs[0].n_points = n
    rig.tick(vx=2.0)
    assert rig.status == LongitudinalSkip.NO_TRAJECTORY
    assert untouched(rig) == before


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e300])
@pytest.mark.parametrize("name", ["x", "y", "z", "qx", "qy", "qz", "qw", "vx", "ax"])
def test_an_unusable_input_skips_the_tick_and_leaves_no_mark(name: str, value: float) -> None:
    rig, twin = cruise(1.0), cruise(1.0)
    for each in (rig, twin):
        each.tick(vx=0.7, ax=0.1)
    before, good = untouched(rig), rig.inputs.copy()
    rig.tick(dt=0.0, **{name: value})
    assert rig.status == LongitudinalSkip.NOT_USABLE
    assert untouched(rig) == before
    rig.inputs[:] = good
    for each in (rig, twin):
        each.tick(vx=0.8)
    assert untouched(rig) == untouched(twin)


@pytest.mark.parametrize("now", [float("nan"), float("inf"), 1e10])
def test_an_unusable_time_skips_the_tick(now: float) -> None:
    rig = cruise(1.0)
    rig.now = now
    rig.tick(vx=1.0, dt=0.0)
    assert rig.status == LongitudinalSkip.NOT_USABLE


def finite(state: Any) -> bool:
    """Whether every number of a record is finite, without the points in it."""
    return all(
        bool(np.isfinite(state[name]).all())
        for name in state.dtype.names
        if state.dtype[name].base.kind == "f"
    )


def scatter(rig: Rig, random: np.random.Generator) -> None:
    """Put a random trajectory in force, of any size from tiny to beyond reckoning."""
    n = int(random.integers(2, 30))
    for name, size in (("x", 1e300), ("y", 1e9), ("z", 1e4), ("v", 1e38), ("acc", 1e38)):
        limit = random.choice([1e-9, 1.0, 1e2, size])
        rig.points[name][:n] = limit * random.uniform(-1, 1, n)
    rig.points["qz"][:n] = random.uniform(-1, 1, n)
    rig.inputs[0].n_points = n


def shake(rig: Rig, random: np.random.Generator) -> None:
    """Give random inputs, half of the time right on a point of the trajectory."""
    size = random.choice([1e-300, 1.0, 1e9])
    for name in ("x", "y", "z", "vx", "ax", "qx", "qy", "qz", "qw"):
        rig.inputs[0][name] = size * random.uniform(-1, 1) / 4
    if random.random() < 0.5:
        point = rig.points[random.integers(0, rig.inputs[0].n_points)]
        for name in ("x", "y", "z", "qx", "qy", "qz", "qw"):
            rig.inputs[0][name] = point[name]
    rig.inputs[0].mode = random.integers(0, 5)


@pytest.mark.parametrize("seed", range(4))
def test_any_finite_input_keeps_the_state_finite(seed: int) -> None:
    random = np.random.default_rng(seed)
    rig = Rig(acc_feedback_gain=0.5, slope_source="trajectory_adaptive", kd=1.0, max_d_effort=1.0)
    scatter(rig, random)
    states, near = set(), 0
    with np.errstate(all="ignore"):  # overflow is what is tried here
        for _ in range(2000):
            if random.random() < 0.1:
                scatter(rig, random)
            shake(rig, random)
            trace = rig.tick(random.choice([-0.1, 0.0, 0.15, 1e3]))
            assert finite(rig.s) and finite(rig.s.pid) and finite(rig.command[0])
            states.add(rig.status)
            near += rig.status >= 0 and not trace.far_from_trajectory
    assert near > 300
    assert states >= {DRIVE, STOPPED, EMERGENCY, LongitudinalSkip.NOT_USABLE}


def test_duplicate_points_under_the_ego_change_nothing() -> None:
    """Two points in one place have no direction; the plain road gives the same command."""
    plain, doubled = cruise(), cruise()
    plain.road([0.0, 5.0, 5.5, 20.0], [1.0, 2.0, 2.0, 3.0], 0.2)
    doubled.road([0.0, 0.0, 5.0, 5.0, 5.0, 5.5, 20.0, 20.0], [1, 1, 2, 2, 2, 2, 3, 3], 0.2)
    for x in (0.0, 4.9, 5.0, 5.1, 19.9, 20.0, 20.5):
        for rig in (plain, doubled):
            rig.tick(x=x, vx=1.5)
        assert plain.command == doubled.command
        assert plain.trace[0].stop_dist == doubled.trace[0].stop_dist


def test_a_trajectory_of_one_place_is_none() -> None:
    rig = cruise()
    rig.road([5.0, 5.0, 5.0], 1.0)
    rig.tick(x=5.0, vx=1.0)
    assert rig.status < 0
