# SPDX-License-Identifier: Apache-2.0
"""Trajectories that are refused as a whole: how many points, how close, how long."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.limits import EXTENSION_POINTS, MAX_POINTS, MAX_REFERENCE
from safety_island.control.status import Refusal
from safety_island.kernel.records import Records
from tests.control.lateral_rig import line, make_points
from tests.golden.harness import firmware


@pytest.fixture(scope="module")
def gate() -> TrajectoryFollower:
    return TrajectoryFollower(firmware())


@pytest.mark.parametrize("count", [0, 1])
def test_too_few_points(gate: TrajectoryFollower, count: int) -> None:
    assert gate.offer_trajectory(line(40.0)[:count], 1000.0) is Refusal.TOO_FEW_POINTS


@pytest.mark.parametrize("count", [-1, 2**40])
def test_an_absurd_count(gate: TrajectoryFollower, count: int) -> None:
    wanted = Refusal.TOO_FEW_POINTS if count < 0 else Refusal.TOO_MANY_POINTS
    assert gate.offer_incoming(count, 1000.0) is wanted


def test_the_most_points(gate: TrajectoryFollower) -> None:
    x = 0.1 * np.arange(MAX_POINTS + 1)
    assert gate.offer_trajectory(make_points(x[:-1]), 1000.0) is Refusal.ACCEPTED
    assert gate.offer_trajectory(make_points(x), 1000.0) is Refusal.TOO_MANY_POINTS
    assert gate.offer_incoming(MAX_POINTS + 1, 1000.0) is Refusal.TOO_MANY_POINTS


@pytest.mark.parametrize("index", [0, 20, 38])
@pytest.mark.parametrize(
    ("dx", "dy", "left"),
    [
        (0.0, 0.0, 39),
        (0.9e-8, -0.9e-8, 39),
        (1.1e-8, 0.0, 40),
        (0.0, -1.1e-8, 39),  # beside the one before, not ahead of it: noise
    ],
)
def test_of_consecutive_points_that_coincide_one_is_left(
    gate: TrajectoryFollower, index: int, dx: float, dy: float, left: int
) -> None:
    """Nearer than 1e-8 m in x and in y."""
    points = make_points(np.arange(40.0) - index)
    points["x"][index + 1 :] += dx - 1.0
    points["y"][index + 1 :] = dy
    assert gate.offer_trajectory(points, 1000.0) is Refusal.ACCEPTED
    assert gate.inputs["n_points"][0] == left


def facing(points: Records, yaws: Any) -> Records:
    """Let each point face a direction [rad]."""
    points["qz"], points["qw"] = np.sin(0.5 * np.asarray(yaws)), np.cos(0.5 * np.asarray(yaws))
    return points


@pytest.mark.parametrize("turned", [0.0, math.pi])
def test_points_may_meet_again_later(gate: TrajectoryFollower, turned: float) -> None:
    """A loop that ends where it began, driven forward or in reverse."""
    angles: Any = np.linspace(0.0, 2.0 * math.pi, 41)
    loop = facing(make_points(5.0 * np.cos(angles), 5.0 * np.sin(angles)), angles + 1.65 + turned)
    assert gate.offer_trajectory(loop, 1000.0) is Refusal.ACCEPTED


@pytest.mark.parametrize(("back", "wanted"), [(0.0499, "ACCEPTED"), (0.0501, "MIXED_DIRECTION")])
@pytest.mark.parametrize("yaw", [0.0, math.pi])
def test_a_way_there_and_back_is_no_trajectory(
    gate: TrajectoryFollower, back: float, wanted: str, yaw: float
) -> None:
    there_and_back = facing(make_points([0.0, 2.0, 2.0 - back, 4.0]), [yaw] * 4)
    assert gate.offer_trajectory(there_and_back, 1000.0) is Refusal[wanted]


@pytest.mark.parametrize(("speed", "wanted"), [(-0.0009, "ACCEPTED"), (-0.0011, "MIXED_DIRECTION")])
def test_speeds_of_both_signs_are_no_trajectory(
    gate: TrajectoryFollower, speed: float, wanted: str
) -> None:
    points = make_points(np.arange(40.0))
    points["v"][10] = speed
    assert gate.offer_trajectory(points, 1000.0) is Refusal[wanted]


def test_points_out_of_order(gate: TrajectoryFollower) -> None:
    order = np.random.default_rng(7).permutation(40)
    shuffled = make_points(np.arange(40.0)[order])
    assert gate.offer_trajectory(shuffled, 1000.0) is Refusal.MIXED_DIRECTION


def test_an_orientation_that_is_nearly_a_unit_becomes_one(gate: TrajectoryFollower) -> None:
    points = make_points(np.arange(40.0))
    points["qw"][20] = 1.009
    points["qz"][21] = 1e-6  # its square counts for nothing: the bits stay
    assert gate.offer_trajectory(points, 1000.0) is Refusal.ACCEPTED
    assert gate.points["qw"][20] == pytest.approx(1.0, abs=1e-15)
    assert gate.points["qw"][21] == 1.0 and gate.points["qz"][21] == 1e-6


@pytest.mark.parametrize("step", [0.02, 0.1, 1.0])
def test_a_path_longer_than_the_reference_can_hold(step: float) -> None:
    """Its 2-D length counts, whatever the number of points; height does not."""
    gate = TrajectoryFollower(firmware(traj_resample_dist=step))
    room = (MAX_REFERENCE - EXTENSION_POINTS) * step
    for angle in (0.0, 0.7, 2.5):
        for share, wanted in ((0.999999, Refusal.ACCEPTED), (1.000001, Refusal.TOO_LONG)):
            along: Any = np.linspace(0.0, room * share, 30)
            points = make_points(along * math.cos(angle), along * math.sin(angle))
            points["z"] = np.linspace(0.0, 1e6, 30)
            assert gate.offer_trajectory(points, 1000.0) is wanted
