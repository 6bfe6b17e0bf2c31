# SPDX-License-Identifier: Apache-2.0
"""Rows 27 to 31, 92 and 93 of the fault catalogue: trajectories that no planner should publish.

And those that planners do publish, whose points have flaws that the path has not.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from safety_island.control.records import POINT
from safety_island.control.status import LongitudinalState
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.warning import InputWarning
from safety_island.kernel.records import Records
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.faults import edit, wire
from tests.faults.checks import (
    bound,
    recovers,
    silent_within,
    stays_active,
    stays_latched,
    warned,
)
from tests.faults.scene import SETTLE_S, SLOW, Row, Scene

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


def at_rest(has_ramp: bool = False) -> Scene:
    """A vehicle that has driven and stands at a stop point of its course, in autonomous mode."""
    scene = Scene(course="stop-and-go", start_speed=2.0, has_ramp=has_ramp)
    scene.run(SETTLE_S)
    for _ in range(400):
        if scene.tick().speed == 0.0:
            scene.run(0.3)
            return scene
    raise AssertionError("it never stopped")


def around(scene: Scene, stations: Any, speed: float = 0.0) -> Records:
    """Points at some metres ahead of the vehicle, along its heading."""
    plant, along = scene.world.plant, np.asarray(stations, float)
    points = np.zeros(len(along), POINT)
    points["x"] = plant.x + along * math.cos(plant.yaw)
    points["y"] = plant.y + along * math.sin(plant.yaw)
    points["qz"], points["qw"] = math.sin(plant.yaw / 2), math.cos(plant.yaw / 2)
    points["v"] = speed
    return points


STANDING = {
    "all at one place": np.zeros(80),
    "the stop point five times": np.r_[0.5 * np.arange(75) - 3.0, [34.0] * 5],
    "from here on the stop point": np.r_[0.5 * np.arange(6) - 3.0, np.zeros(40)],
    "the vehicle's place, then a path": np.r_[np.zeros(20), 0.5 * np.arange(1, 60)],
    "two places": np.r_[-2.0, np.zeros(9)],
}


@pytest.mark.parametrize("name", STANDING)
@pytest.mark.parametrize("noise", [0.0, 0.003])
@pytest.mark.parametrize("has_ramp", [False, True], ids=["dds", "can_only"])
def test_row_92_a_standing_vehicle_stays_in_operation(
    name: str, noise: float, has_ramp: bool
) -> None:
    """Whatever lies on top of each other, with noise along the path and aside, anew each time."""
    scene, rng = at_rest(has_ramp=has_ramp), np.random.default_rng(92)

    def still(points: Records) -> Records:
        found = around(scene, STANDING[name])
        for field in ("x", "y"):
            found[field] += rng.normal(0.0, noise, len(found))
        return found

    scene.inject(wire.change(edit.points(still)), "trajectory")
    rows = stays_active(scene, 4.0)
    assert {row.speed for row in rows} == {0.0}
    assert not scene.input("trajectory").refused
    scene.clear()
    assert max(row.speed for row in stays_active(scene, 8.0)) > 1.0, "it drives on"


UNDRIVABLE: dict[str, Callable[[Scene], Records]] = {
    "one place elsewhere": lambda scene: around(scene, [30.0] * 20),
    "one place that is no stop": lambda scene: around(scene, [0.0] * 20, 1.0),
    "to and fro": lambda scene: around(scene, [-5.0, 0.0, 5.0, 0.0, -5.0]),
    "one point": lambda scene: around(scene, [0.0]),
    "no number": lambda scene: around(scene, [-5.0, 0.0, math.nan, 5.0]),
    "out of reach": lambda scene: around(scene, 100.0 + np.arange(60.0)),
}


@pytest.mark.parametrize("name", UNDRIVABLE)
@pytest.mark.parametrize("has_ramp", [False, True], ids=["dds", "can_only"])
def test_row_92_what_cannot_be_followed_latches_nothing_at_rest(name: str, has_ramp: bool) -> None:
    """The output ends, and goes on by itself with the first trajectory that can be followed."""
    scene = at_rest(has_ramp=has_ramp)
    bad = UNDRIVABLE[name](scene)
    scene.inject(wire.change(edit.points(lambda _: bad)), "trajectory")
    rows = scene.run(12.0)
    assert rows[-1].output == "silent" and {row.speed for row in rows} == {0.0}
    assert rows[-1].state is State.INIT
    assert rows[-1].reason in (Reason.INPUT_STALE, Reason.MPC_FAILED)
    scene.clear()
    scene.run(1.0)
    stays_active(scene, 2.0)


@pytest.mark.parametrize("name", ["one point", "to and fro"])
def test_row_92_in_motion_it_is_latched(name: str) -> None:
    scene = Scene().drive()
    bad = UNDRIVABLE[name](scene)
    since = scene.inject(wire.change(edit.points(lambda _: bad)), "trajectory")
    silent_within(scene, since, bound("trajectory", SLOW))
    recovers(scene, Reason.INPUT_STALE)


def test_row_92_a_dead_planner_is_latched_at_rest() -> None:
    """Nothing comes, or the same again and again: that is another loss than a bad trajectory."""
    for fault in (wire.drop, wire.frozen_stamp()):
        scene = at_rest()
        scene.inject(fault, "trajectory")
        scene.run(3.0)
        assert scene.rows[-1].state is State.SILENT
        scene.clear()
        scene.run(1.0)
        stays_latched(scene, Reason.INPUT_STALE)


def inserted(scene: Scene, off: float, gap: float, aside: float, ahead: float) -> edit.Edit:
    """Insert a stop point beside another, ``ahead`` [m] of the vehicle, its yaw off."""
    place = scene.world.plant.x + ahead

    def change(points: Records) -> Records:
        at = int(np.argmin(np.abs(points["x"] - place)))
        found = np.insert(points, at, points[at])
        yaw = 2.0 * math.atan2(points["qz"][at], points["qw"][at])
        found["x"][at] -= gap * math.cos(yaw) + aside * math.sin(yaw)
        found["y"][at] -= gap * math.sin(yaw) - aside * math.cos(yaw)
        found["qz"][at], found["qw"][at] = math.sin((yaw + off) / 2), math.cos((yaw + off) / 2)
        return found

    return edit.points(change)


@pytest.mark.parametrize("off", [0.0, 1.2, math.pi / 2, -2.4, math.pi])
@pytest.mark.parametrize(("gap", "aside"), [(0.002, 0.0), (0.002, 0.002), (0.01, -0.003)])
def test_row_93_a_point_beside_another_swings_no_steering(
    off: float, gap: float, aside: float
) -> None:
    """Driven over as if it were not there, and warned of when its yaw is wrong."""
    twin, scene = Scene().drive(), Scene().drive()
    found = warned(scene)
    scene.inject(wire.change(inserted(scene, off, gap, aside, 12.0)), "trajectory")
    rows, others = stays_active(scene, 5.0), stays_active(twin, 5.0)
    for row, other in zip(rows, others, strict=True):
        assert row.command is not None and other.command is not None
        assert row.command[2] == pytest.approx(other.command[2], abs=0.01), "the angle"
        assert row.command[3:7] == pytest.approx(other.command[3:7], abs=0.05)
    assert bool(found["trajectory"] & InputWarning.YAW_REPLACED) == (off != 0.0)
    assert not scene.input("trajectory").refused
    assert ("contradict the path" in scene.log_text) == (off != 0.0)
    scene.clear()
    stays_active(scene, 1.0)
    assert not scene.input("trajectory").warnings
