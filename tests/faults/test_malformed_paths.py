"""Rows 27 to 31 of the fault catalogue: trajectories that no planner should publish."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from safety_island.control.records import POINT, Records
from safety_island.control.status import LongitudinalState
from safety_island.gate.reason import SampleReason
from safety_island.life_cycle.reason import Reason
from tests.faults import edit, wire
from tests.faults.checks import bound, recovers, silent_within, stays_active
from tests.faults.scene import SLOW, Row, Scene

RATE_LIMIT = math.radians(60.0)
"""Highest steering rate of the tables [rad/s]."""


def each_twice(points: Records, shift: float = 0.0) -> Records:
    """Repeat each point, the second time a little farther along its orientation [m]."""
    twice = np.repeat(points, 2)
    yaw = 2.0 * np.arctan2(twice["qz"][1::2], twice["qw"][1::2])
    twice["x"][1::2] += shift * np.cos(yaw)
    twice["y"][1::2] += shift * np.sin(yaw)
    return twice


def there_and_back(points: Records) -> Records:
    """Lead forward to the middle, and then back along the same points."""
    half = len(points) // 2
    return np.concatenate([points[:half], points[half - 2 :: -1]])


def two_swapped(points: Records) -> Records:
    """Put two neighbours in the wrong order."""
    points[[30, 31]] = points[[31, 30]]
    return points


def flips_sign(points: Records) -> None:
    """Demand to drive backward from the middle on."""
    points["v"][len(points) // 2 :] *= -1.0


def refuse(change: edit.Edit, reason: SampleReason) -> None:
    """The old path stays in force until it is too old; commands stay smooth and finite."""
    scene = Scene().drive()
    since = scene.inject(wire.change(change), "trajectory")
    rows = stays_active(scene, 0.6)
    assert all(is_finite(row) for row in rows)
    silent_within(scene, since, bound("trajectory", SLOW))
    assert set(scene.input("trajectory").refused) == {reason}
    recovers(scene, Reason.INPUT_STALE)


def is_finite(row: Row) -> bool:
    """Whether every number of a command is one."""
    return row.command is not None and math.isfinite(sum(row.command[2:7]))


def test_row_27_of_coincident_points_one_is_left() -> None:
    """Each point twice is the path that it would be with each of them once."""
    twin, scene = Scene().drive(), Scene().drive()
    scene.inject(wire.change(edit.points(each_twice)), "trajectory")
    for row, other in zip(stays_active(scene, 5.0), stays_active(twin, 5.0), strict=True):
        assert row.command is not None and other.command is not None
        assert row.command[2:7] == other.command[2:7]
    assert not scene.input("trajectory").refused


@pytest.mark.parametrize("shift", [1e-6, 1e-4, 9e-4])
def test_row_27_points_that_nearly_coincide_do_no_harm(shift: float) -> None:
    twin, scene = Scene().drive(), Scene().drive()
    scene.inject(wire.change(edit.points(lambda p: each_twice(p, shift))), "trajectory")
    for row, other in zip(stays_active(scene, 5.0), stays_active(twin, 5.0), strict=True):
        assert row.command is not None and other.command is not None
        assert row.command[2:7] == pytest.approx(other.command[2:7], abs=0.05)


@pytest.mark.parametrize("change", [there_and_back, two_swapped], ids=lambda c: c.__name__)
def test_row_28_points_that_lead_both_ways_are_refused(change: edit.Change) -> None:
    refuse(edit.points(change), SampleReason.MIXED_DIRECTION)


def test_row_28_shuffled_points_are_refused() -> None:
    order = np.random.default_rng(28)
    refuse(
        edit.points(lambda points: points[order.permutation(len(points))]), SampleReason.TOO_LONG
    )


def test_row_28_a_path_that_closes_a_loop_is_driven() -> None:
    """One and a quarter rounds of a circle of 15 m, its beginning under its end."""
    scene = Scene().drive()
    plant, radius = scene.world.plant, 15.0
    turn = np.arange(0.0, 2.5 * math.pi, 0.5 / radius)
    circle = np.zeros(len(turn), POINT)
    circle["x"] = plant.x + radius * (np.sin(plant.yaw + turn) - math.sin(plant.yaw))
    circle["y"] = plant.y - radius * (np.cos(plant.yaw + turn) - math.cos(plant.yaw))
    circle["qz"], circle["qw"] = np.sin((plant.yaw + turn) / 2), np.cos((plant.yaw + turn) / 2)
    circle["v"] = 5.0
    scene.inject(wire.change(edit.points(lambda _: circle)), "trajectory")
    assert all(is_finite(row) for row in stays_active(scene, 30.0))


def test_row_28_a_path_that_leads_backward_is_driven_backward() -> None:
    scene = Scene(start_speed=0.0)
    scene.world.plant.gear = -1

    def backward(points: Records) -> Records:
        changed = points[::-1].copy()
        changed["v"] = -1.0
        return changed

    scene.inject(wire.change(edit.points(backward)), "trajectory")
    scene.run(2.0)
    rows = stays_active(scene, 3.0)
    assert all(row.command is not None and row.command.velocity < 0.0 for row in rows)
    assert rows[-1].speed < -0.5


def moved(points: Records) -> None:
    """Lead along a path 100 m away."""
    points["x"] += 100.0
    points["y"] += 100.0


def turned_round(points: Records) -> None:
    """Turn every orientation by 180 degrees."""
    points["qz"], points["qw"] = -points["qw"].copy(), points["qz"].copy()


@pytest.mark.parametrize("change", [moved, turned_round], ids=lambda c: c.__name__)
@pytest.mark.parametrize("has_ramp", [False, True], ids=["dds", "can_only"])
def test_row_29_a_path_out_of_reach_is_not_followed(change: edit.Change, has_ramp: bool) -> None:
    """At once the steering is held and the speed goes down; then the output ends."""
    scene = Scene(has_ramp=has_ramp).drive()
    before = scene.rows[-1].command
    since = scene.inject(wire.change(edit.points(change)), "trajectory")
    failure_s = scene.parameters.life_cycle.mpc_failure_time
    rows = scene.run(failure_s)
    assert before is not None
    for row, following in pairwise([row.command for row in rows if row.output == "published"]):
        assert row is not None and following is not None
        assert row.steering_tire_angle == before.steering_tire_angle
        assert following.acceleration < row.acceleration
        assert following.velocity < row.velocity
    if has_ramp:
        outputs = [row.output for row in scene.run(9.0)]
        assert outputs[-1] == "silent" and "ramp" in outputs
        assert scene.world.plant.speed == 0.0
    else:
        silent_within(scene, since, failure_s + 2 * SLOW)
        assert scene.rows[-1].reason is Reason.MPC_FAILED
    assert scene.follower.trace["lon_state"][0] == LongitudinalState.EMERGENCY
    recovers(scene, Reason.MPC_FAILED)


@pytest.mark.parametrize("step_m", [0.3, 1.0])
def test_row_30_a_path_that_jumps_moves_the_steering_at_its_rate(step_m: float) -> None:
    scene = Scene().drive()
    side = [step_m]

    def jump(points: Records) -> None:
        side[0] = -side[0]
        points["y"] += side[0] / 2

    scene.inject(wire.change(edit.points(jump)), "trajectory")
    commands = [row.command for row in stays_active(scene, 10.0)]
    angles = [command.steering_tire_angle for command in commands if command is not None]
    assert max(map(abs, angles)) > 1e-3
    assert all(abs(b - a) <= RATE_LIMIT * SLOW + 1e-6 for a, b in pairwise(angles))


def test_row_31_speed_zero_brakes_at_once() -> None:
    scene = Scene().drive()

    def stop(points: Records) -> None:
        points["v"] = 0.0

    scene.inject(wire.change(edit.points(stop)), "trajectory")
    commands = [row.command for row in stays_active(scene, 4.0)]
    values = [(c.acceleration, c.velocity) for c in commands if c is not None]
    assert all(b <= a for a, b in pairwise(values[:8]))
    assert values[2][0] < 0.0
    assert scene.world.plant.speed == 0.0


def test_row_31_speeds_of_both_signs_are_refused() -> None:
    refuse(edit.points(flips_sign), SampleReason.MIXED_DIRECTION)


def test_row_31_a_stop_in_mid_path_is_not_passed() -> None:
    scene = Scene().drive()
    place, planner = scene.world.planner.place.station, scene.world.planner

    def obstacle(points: Records) -> None:
        """Slow down to a stop 30 m from where it began."""
        behind = min(planner.place.segment, planner._behind)
        ahead = 30.0 - (planner.place.station - place) - 0.5 * (np.arange(len(points)) - behind)
        points["v"] = np.minimum(points["v"], np.sqrt(2.0 * np.maximum(ahead, 0.0)))

    scene.inject(wire.change(edit.points(obstacle)), "trajectory")
    stays_active(scene, 20.0)
    assert scene.world.plant.speed == 0.0
    assert 28.0 < planner.place.station - place < 32.0


def test_row_31_a_reverse_demand_does_not_speed_up_forward_motion() -> None:
    """Gear and motion say forward, the path says backward: brake first."""
    scene = Scene().drive()
    speed = scene.world.plant.speed

    def reverse(points: Records) -> None:
        points["v"] *= -1.0

    scene.inject(wire.change(edit.points(reverse)), "trajectory")
    assert max(row.speed for row in scene.run(5.0)) < speed + 0.5
