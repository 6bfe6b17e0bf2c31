# SPDX-License-Identifier: Apache-2.0
"""The join of both controllers: readiness, tick, and what no input may do."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from safety_island.control.follower import INPUT_NAMES, TrajectoryFollower
from safety_island.control.limits import MAX_POINTS
from safety_island.control.records import POINT
from safety_island.control.reference_positions import ensure
from safety_island.control.status import LongitudinalState, MpcStatus, Refusal
from tests.control.follower_rig import driving, memory
from tests.control.lateral_rig import PERIOD, START, line, make_points
from tests.golden.harness import firmware

STILL = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


def test_every_input_is_needed() -> None:
    follower = TrajectoryFollower(firmware())
    offers: dict[str, Callable[[], Refusal]] = {
        "trajectory": lambda: follower.offer_trajectory(line(20.0), START),
        "odometry": lambda: follower.offer_odometry(*STILL),
        "steering": lambda: follower.offer_steering(0.0),
        "acceleration": lambda: follower.offer_acceleration(0.0),
        "operation mode": lambda: follower.offer_operation_mode(2, True),
    }
    assert tuple(offers) == INPUT_NAMES
    for i, offer in enumerate(offers.values()):
        assert follower.missing() == INPUT_NAMES[i:]
        assert not follower.is_ready() and not follower.step(START)
        assert follower.command.tobytes() == bytes(follower.command.nbytes)
        assert offer() is Refusal.ACCEPTED
    assert follower.missing() == () and follower.is_ready()
    assert follower.step(START)
    command = follower.command[0]
    assert command.stamp == command.longitudinal_stamp == START


def test_the_operation_mode_is_waited_for() -> None:
    """The firmware takes it as received, STOP, from the start."""
    follower = TrajectoryFollower(firmware())
    follower.offer_trajectory(line(20.0), START)
    follower.offer_odometry(*STILL)
    follower.offer_steering(0.0)
    follower.offer_acceleration(0.0)
    assert follower.missing() == ("operation mode",) and not follower.step(START)


def test_a_path_of_two_points_is_not_enough_until_there_was_a_longer_one() -> None:
    """Then the lateral side keeps the longer one and the longitudinal side takes the new."""
    follower = TrajectoryFollower(firmware())
    follower.offer_odometry(*STILL)
    follower.offer_steering(0.0)
    follower.offer_acceleration(0.0)
    follower.offer_operation_mode(2, True)
    assert follower.offer_trajectory(make_points([0.0, 50.0]), START) is Refusal.ACCEPTED
    assert follower.missing() == () and not follower.is_ready()
    follower.offer_trajectory(line(20.0), START)
    assert follower.step(START)
    assert follower.trace[0].stop_dist == pytest.approx(20.0)
    follower.offer_trajectory(make_points([0.0, 50.0]), START)
    assert follower.step(START + PERIOD)
    assert follower.trace[0].stop_dist == pytest.approx(50.0)
    lat = follower._lateral[0]
    ensure(lat, 0, lat.ref_n)
    assert lat.rx[: lat.ref_n].max() < 20.0


def test_each_side_gets_what_the_other_knew_one_tick_ago() -> None:
    follower = driving()
    follower.trace["is_steer_converged"] = True
    follower.run_longitudinal(START + 1.0)
    assert not follower._longitudinal[0].is_steer_converged
    follower.sync()
    assert follower._longitudinal[0].is_steer_converged


def test_statuses_are_named() -> None:
    follower = driving()
    assert follower.run_lateral(START + 1.0) is MpcStatus.SOLVED
    assert LongitudinalState(follower.run_longitudinal(START + 1.0)) in LongitudinalState


def test_the_trajectory_in_force_and_the_one_that_comes_in_are_two() -> None:
    """A decoder may write into ``incoming`` at any time."""
    follower = driving()
    before = memory(follower)
    follower.incoming["x"][:] = math.nan
    assert memory(follower) == before
    assert follower.offer_trajectory(line(9.0), START) is Refusal.ACCEPTED
    assert follower.inputs[0].n_points == 10 and follower.inputs[0].trajectory_id == 2
    np.testing.assert_array_equal(follower.points[:10], line(9.0))


def test_points_of_the_wrong_kind_are_a_callers_mistake() -> None:
    """Not an input: the types are fixed, so it is told where it is made."""
    with pytest.raises((TypeError, ValueError)):
        driving().offer_trajectory(np.zeros((3, MAX_POINTS)), START)


def test_a_point_is_laid_out_as_on_the_wire() -> None:
    assert POINT.itemsize == 88
    assert POINT.names[:8] == ("x", "y", "z", "qx", "qy", "qz", "qw", "v")
