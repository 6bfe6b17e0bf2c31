# SPDX-License-Identifier: Apache-2.0
"""Trajectories as planners send them: what is cleaned, what is left alone, what is refused."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.limits import MAX_POINTS
from safety_island.control.records import POINT
from safety_island.control.status import LongitudinalState, MpcStatus, Refusal
from safety_island.kernel.records import Records
from safety_island.params import load_set
from tests.control.follower_rig import memory
from tests.control.lateral_rig import make_points
from tests.golden.harness import firmware, played, recorded, run_paths

OFF = (0.8, -1.2, math.pi / 2, -2.4, math.pi)
"""How far [rad] an orientation is wrong."""


def path(bend: float = 0.0, step: float = 0.5, n: int = 90, sign: float = 1.0) -> Records:
    """A path along an arc of that curvature [1/m], driven forward or (-1) backward."""
    s = step * np.arange(n) - 5.0
    angle = bend * s
    x = np.sin(angle) / bend if bend else s
    y = (1.0 - np.cos(angle)) / bend if bend else 0.0 * s
    speeds = np.minimum(4.0, np.sqrt(2.0 * np.maximum(s[-5] - s, 0.0)))
    points = make_points(x, y, sign * speeds, angle + (0.0 if sign > 0.0 else math.pi))
    points["acc"] = np.where(speeds < 4.0, -sign, 0.0)
    return points


PATHS = {
    "straight": path(),
    "left": path(0.1),
    "hairpin": path(-0.3, 0.2),
    "coarse": path(0.15, 2.0),
    "reverse": path(sign=-1.0),
    "reverse left": path(0.1, sign=-1.0),
}
every_path = pytest.mark.parametrize("name", PATHS)


@pytest.fixture(scope="module")
def door() -> TrajectoryFollower:
    """A follower with the thresholds of the default set."""
    return TrajectoryFollower(load_set("default"))


def place_vehicle(door: TrajectoryFollower, x: float = 0.0, vx: float = 0.0) -> None:
    """Put the vehicle on the x axis, in autonomous mode."""
    door.offer_odometry(x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, vx, 0.0, 0.0)
    door.offer_steering(0.0)
    door.offer_acceleration(0.0)
    door.offer_operation_mode(2, True)


def cleaned(door: TrajectoryFollower, points: Records) -> Records:
    """What the controllers get of a trajectory."""
    assert door.offer_trajectory(points, 1000.0) is Refusal.ACCEPTED
    return door.points[: door.inputs["n_points"][0]].copy()


def yaws(points: Records) -> Any:
    return 2.0 * np.arctan2(points["qz"], points["qw"])


def turn(points: Records, places: Sequence[int], angle: float) -> Records:
    """Turn the orientation of some points by an angle [rad]."""
    turned = points.copy()
    yaw = yaws(points)
    yaw[list(places)] += angle
    turned["qz"], turned["qw"] = np.sin(yaw / 2), np.cos(yaw / 2)
    return turned


def beside(
    points: Records, place: int, along: float, aside: float = 0.0, **values: float
) -> Records:
    """Insert a copy of a point at some metres ahead of it on the path (or behind), and aside."""
    more = np.insert(points, place + (along >= 0.0), points[place])
    new = more[place + (along >= 0.0)]
    before, after = points[max(place - 1, 0)], points[place + 1]
    dx, dy = after["x"] - before["x"], after["y"] - before["y"]
    length = math.hypot(dx, dy)
    new["x"] += (along * dx - aside * dy) / length
    new["y"] += (along * dy + aside * dx) / length
    for name, value in values.items():
        new[name] = value
    return more


@pytest.mark.parametrize("file", run_paths(), ids=lambda file: f"{file.parent.name}-{file.stem}")
def test_no_bit_of_a_recorded_trajectory_changes(door: TrajectoryFollower, file: Any) -> None:
    run = recorded(f"{file.parent.name}/{file.stem}")
    for tick in range(0, run.ticks, 7):
        if run.has_new_trajectory(tick):
            points = run.trajectory(tick)
            if door.offer_trajectory(points, 1000.0) is Refusal.ACCEPTED:
                assert door.points[: len(points)].tobytes() == points.tobytes()
                assert door.inputs["n_points"][0] == len(points) and not door.turned_points


@every_path
@pytest.mark.parametrize("step", [0.002, 0.01, 0.02, 0.1])
def test_no_bit_of_a_good_trajectory_changes(
    door: TrajectoryFollower, name: str, step: float
) -> None:
    """However dense it is, and with a stop point inserted that lies on the path."""
    points = PATHS[name]
    assert cleaned(door, points).tobytes() == points.tobytes()
    dense = path(0.05, step, min(4000, int(40.0 / step)))
    assert cleaned(door, dense).tobytes() == dense.tobytes()
    ahead = beside(points, 20, 0.002, v=0.0)
    assert cleaned(door, ahead).tobytes() == ahead.tobytes()


@every_path
@pytest.mark.parametrize("off", OFF)
@pytest.mark.parametrize(
    "places", [[0], [1], [40], [-1], [0, 1, 2], [30, 31, 32, 33], [10, 40, 70], range(20, 50)]
)
def test_orientations_that_contradict_the_path_are_replaced(
    door: TrajectoryFollower, name: str, off: float, places: Sequence[int]
) -> None:
    """At the start, inside, at the end, several in a row; at the ends half a bend is left."""
    points = PATHS[name]
    found = cleaned(door, turn(points, places, off))
    away = np.abs((yaws(found) - yaws(points) + math.pi) % (2.0 * math.pi) - math.pi)
    assert away.max() < 0.16
    assert door.turned_points == len(places)
    for field in POINT.names:
        if field not in ("qz", "qw"):
            np.testing.assert_array_equal(found[field], points[field])


def test_pitch_and_roll_of_a_replaced_orientation_stay(door: TrajectoryFollower) -> None:
    points = path()
    pitch, roll = -0.1, 0.05
    points["qx"] = math.cos(pitch / 2) * math.sin(roll / 2)
    points["qy"] = math.sin(pitch / 2) * math.cos(roll / 2)
    points["qz"] = -math.sin(pitch / 2) * math.sin(roll / 2)
    points["qw"] = math.cos(pitch / 2) * math.cos(roll / 2)
    wrong = points.copy()
    half = 1.0  # rad, half of the turn about the vertical
    q = [points[name][40] for name in ("qx", "qy", "qz", "qw")]
    c, s = math.cos(half), math.sin(half)
    for name, value in zip(
        ("qx", "qy", "qz", "qw"),
        (c * q[0] - s * q[1], c * q[1] + s * q[0], c * q[2] + s * q[3], c * q[3] - s * q[2]),
        strict=True,
    ):
        wrong[name][40] = value
    found = cleaned(door, wrong)
    for name, value in zip(("qx", "qy", "qz", "qw"), q, strict=True):
        assert found[name][40] == pytest.approx(value, abs=1e-9)


@pytest.mark.parametrize("off", [1.2, math.pi])
def test_where_most_orientations_are_wrong_none_is_replaced(
    door: TrajectoryFollower, off: float
) -> None:
    """Neighbours agree with each other, and not with the path: that is another fault."""
    points = turn(path(), range(90), off)
    assert cleaned(door, points).tobytes() == points.tobytes()
    assert not door.turned_points


def test_a_sharp_turn_is_no_contradiction(door: TrajectoryFollower) -> None:
    """Whatever side of the corner its orientation follows, or any in between."""
    corner = make_points([0.0, 2.0, 4.0, 4.0, 4.0], [0.0, 0.0, 0.0, 2.0, 4.0], yaw=0.0)
    for yaw in (0.0, 0.8, math.pi / 2, 2.0):
        points = turn(corner, [2], yaw)
        points = turn(points, [3, 4], math.pi / 2)
        assert cleaned(door, points).tobytes() == points.tobytes()


@every_path
@pytest.mark.parametrize(("gap", "aside"), [(0.002, 0.0), (0.002, 0.005), (0.01, -0.005)])
@pytest.mark.parametrize("off", [0.0, 0.1, 1.2, math.pi])
def test_a_stop_point_beside_another_stops_and_turns_nothing(
    door: TrajectoryFollower, name: str, gap: float, aside: float, off: float
) -> None:
    """Some millimetres ahead of a point or behind it, to its side, its yaw far off."""
    points = PATHS[name]
    for along in (gap, -gap):
        more = beside(points, 40, along, aside, v=0.0)
        place = 40 + (along > 0.0)
        found = cleaned(door, turn(more, [place], off))
        assert (found["v"][38:44] == 0.0).sum() == 1, "the stop point is there, once"
        stop = found[38 + int(np.argmin(np.abs(found["v"][38:44])))]
        assert math.hypot(stop["x"] - points["x"][40], stop["y"] - points["y"][40]) < 0.012
        lean = np.arctan2(np.diff(found["y"]), np.diff(found["x"])) - yaws(found)[:-1]
        lean = np.abs((lean + math.pi / 2) % math.pi - math.pi / 2)
        assert lean.max() < 0.27, "no step leads aside, but by the bend of the path"


def test_of_two_points_at_one_place_the_slower_speed_is_left(door: TrajectoryFollower) -> None:
    for first, second in ((2.0, 0.0), (0.0, 2.0)):
        points = np.repeat(path(), 2)
        points["v"][80], points["v"][81] = first, second
        points["acc"][80 + (second == 0.0)] = -0.75
        found = cleaned(door, points)
        assert len(found) == 90
        assert found["v"][40] == 0.0 and found["acc"][40] == -0.75


@pytest.mark.parametrize("count", [2, 5, 500])
def test_a_stop_point_repeated_is_one(door: TrajectoryFollower, count: int) -> None:
    points = path()
    more = np.concatenate([points, np.repeat(points[-1:], count)])
    assert cleaned(door, more).tobytes() == points.tobytes()


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("step", [0.002, 0.02, 0.1])
def test_noise_of_some_millimetres_gives_no_direction(
    door: TrajectoryFollower, step: float, sign: float
) -> None:
    """3 mm along the path and beside it; what is left leads on, and leans nowhere far."""
    rng = np.random.default_rng(71)
    for _ in range(5):
        points = path(0.02, step, min(4000, int(30.0 / step)), sign)
        for field in ("x", "y"):
            points[field] += rng.normal(0.0, 0.003, len(points))
        found = cleaned(door, points)
        along = np.cos(yaws(found)[:-1]) * np.diff(found["x"])
        along += np.sin(yaws(found)[:-1]) * np.diff(found["y"])
        along *= sign
        assert along.min() > -0.03 and (along > 0.0).mean() > 0.99
        assert door.turned_points == 0


def test_two_places_are_a_straight_path(door: TrajectoryFollower) -> None:
    """Both controllers can follow a place, and another one repeated."""
    points = make_points([0.0, *[3.0] * 9], v=[1.0, *[0.0] * 9], yaw=0.0)
    found = cleaned(door, points)
    assert found["x"].tolist() == [0.0, 1.5, 3.0] and found["v"].tolist() == [1.0, 0.5, 0.0]
    assert found["qw"].tolist() == [1.0, 1.0, 1.0]


@pytest.mark.parametrize("noise", [0.0, 0.003])
@pytest.mark.parametrize("count", [3, 80, MAX_POINTS])
def test_stop_points_at_one_place_hold_a_vehicle_that_stands_there(
    door: TrajectoryFollower, count: int, noise: float
) -> None:
    rng = np.random.default_rng(5)
    x, y = rng.normal(0.0, noise, (2, count))
    points = make_points(x, y, v=0.0, yaw=0.0)
    place_vehicle(door)
    found = cleaned(door, points)
    assert found["x"] == pytest.approx([-1.0, 0.0, 1.0], abs=0.02)
    assert not found["v"].any() and len(found) == 3
    for tick in range(20):
        assert door.offer_trajectory(points, 1000.0 + tick) is Refusal.ACCEPTED
        assert door.step(1000.0 + 0.15 * tick)
        assert door.trace["mpc_status"][0] == MpcStatus.SOLVED
        assert door.trace["lon_state"][0] == LongitudinalState.STOPPED
        assert door.command["velocity"][0] == 0.0


@pytest.mark.parametrize(
    ("vx", "x", "yaw", "speed"),
    [(0.2, 0, 0, 0), (-0.2, 0, 0, 0), (0, 4, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)],
)
def test_points_at_one_place_are_refused_otherwise(
    door: TrajectoryFollower, vx: float, x: float, yaw: float, speed: float
) -> None:
    """The vehicle moves, is elsewhere, faces another way; or they are no stop points."""
    points = make_points([float(x)] * 20, v=float(speed), yaw=float(yaw))
    place_vehicle(door, vx=vx)
    before = memory(door)
    assert door.offer_trajectory(points, 1000.0) is Refusal.COINCIDENT_POINTS
    assert memory(door) == before


def test_a_wrong_orientation_hides_no_way_back(door: TrajectoryFollower) -> None:
    """A path that leads to and fro is refused, though fewer points lead back than on."""
    points = path(n=60)
    points["v"] = 1.0
    back = np.concatenate([points, points[-2:-20:-1]])
    assert door.offer_trajectory(back, 1000.0) is Refusal.MIXED_DIRECTION
    assert door.offer_trajectory(turn(back, [5], 2.0), 1000.0) is Refusal.MIXED_DIRECTION


def test_a_path_that_is_too_long_is_so_after_cleaning(door: TrajectoryFollower) -> None:
    points = make_points(np.linspace(0.0, 1e5, 30))
    points[11] = points[10]
    assert door.offer_trajectory(points, 1000.0) is Refusal.TOO_LONG


@pytest.mark.parametrize("off", [0.05, 0.2, 0.45])
def test_two_close_points_at_the_start_do_not_turn_the_driving_direction_round(
    off: float,
) -> None:
    """A spline through their yaws would swing by radians between them and the next point."""
    door = TrajectoryFollower(load_set("default"))
    for gap in (0.002, 0.01, 0.04):
        points = turn(beside(path()[10:], 0, gap), [1], off)
        cleaned(door, points)
        place_vehicle(door, x=0.1, vx=1.0)
        assert door.step(1000.0)
        assert door.trace["is_forward_shift"][0]
        assert abs(door.command["steering_tire_angle"][0]) < 0.01


def test_a_drive_over_dirty_points_is_the_drive_over_clean_ones() -> None:
    """Each point of a recording twice, and its stop point ten times: the same commands."""
    run = recorded("stop_and_go/ctrl0.15_unconstraint_fast")
    clean, dirty = TrajectoryFollower(firmware()), TrajectoryFollower(firmware())
    offer = dirty.offer_trajectory

    def each_twice(points: Records, stamp: float, start: float = 0.0) -> Refusal:
        return offer(
            np.concatenate([np.repeat(points, 2), np.repeat(points[-1:], 9)]), stamp, start
        )

    dirty.offer_trajectory = each_twice  # type: ignore[method-assign]
    for (_, now), _ in zip(played(run, clean), played(run, dirty), strict=True):
        assert clean.step(now) == dirty.step(now)
        assert clean.command.tobytes() == dirty.command.tobytes()
