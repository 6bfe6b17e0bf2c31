# SPDX-License-Identifier: Apache-2.0
"""The reference is worked out where it is read: what comes of it is that of the whole reference."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safety_island.control.lateral_state import LATERAL_STATE
from safety_island.control.reference_positions import ensure
from safety_island.kernel.kernel import entry
from safety_island.kernel.records import Records
from tests.control.lateral_rig import Rig, Values, circle, line, make_points, on_path

COLUMNS = ("rx", "ry", "rz", "rv")
NEAR: dict[str, Any] = {"ego_nearest_dist_threshold": 3.0, "ego_nearest_yaw_threshold": 1.046}
"""As Autoware has it."""
GLOBAL: dict[str, Any] = {"ego_nearest_dist_threshold": 0.0}
"""As the firmware has it: the nearest of all points."""
LIMITS = {"near": NEAR, "wide": NEAR | {"ego_nearest_dist_threshold": 8.0}, "global": GLOBAL}


@entry(LATERAL_STATE, int, int)
def ensure_points(state: Any, low: int, high: int) -> Any:
    """Ask for points; returns the end of the stretch."""
    return ensure(state[0], low, high)


@pytest.fixture(autouse=True, scope="module")
def _prepared() -> None:
    ensure_points.prepare()


def state_of(rig: Rig) -> Any:
    """The state as the last tick left it; ``rig.lat`` would work the reference out."""
    return rig.follower._lateral[0]


def columns(lat: Any, low: int = 0, high: int | None = None) -> Values:
    high = lat.ref_n + 1 if high is None else high
    return np.array([lat[name][low:high] for name in COLUMNS])


def whole_of(rig: Rig) -> Any:
    """A copy of the state whose reference is worked out to both ends."""
    state = rig.follower._lateral.copy()
    ensure_points.call(state, 0, int(state[0].ref_n))
    return state[0]


@pytest.mark.parametrize("limits", LIMITS)
def test_what_is_not_read_costs_nothing(limits: str) -> None:
    """Neither what lies behind the vehicle nor what lies beyond the horizon."""
    rig = on_path(line(400.0), **LIMITS[limits])
    rig.place(150.0, 0.4)
    rig.tick()
    lat = state_of(rig)
    assert lat.ref_n == 4000
    assert 1350 < lat.first < lat.segment and lat.segment + lat.window < lat.ready < 2500


@pytest.mark.parametrize("stride", [1, 15, 16, 17, 1000])
def test_any_stride_gives_the_same_bits(stride: int) -> None:
    path = circle(40.0, 120.0, 0.7, v=3.0)
    rig, whole = on_path(path, **NEAR), on_path(path, **NEAR)
    for one in (rig, whole):
        one.place(40.0 * math.sin(1.0), 40.0 * (1.0 - math.cos(1.0)), 1.0)
        one.tick()
    lat, state = state_of(rig), rig.follower._lateral
    for away in range(0, lat.ref_n + stride, stride):
        assert ensure_points.call(state, 400 - away, 400 + away) > min(400 + away, lat.ref_n)
    np.testing.assert_array_equal(columns(lat), columns(whole.lat))


def test_the_end_is_closed_once_it_is_reached() -> None:
    rig = on_path(line(50.0), **NEAR)
    assert rig.lat.ref_n == rig.lat.ready == 0, "nothing is there before the first tick"
    rig.tick()
    lat, state = state_of(rig), rig.follower._lateral
    n = int(lat.ref_n)
    assert ensure_points.call(state, n - 1, n - 1) == ensure_points.call(state, n, n + 5) == n + 1
    end = columns(lat)[:, -2:]
    np.testing.assert_array_equal(end[:, 0], end[:, 1])
    assert end[3, 0] == 0.0


def test_a_path_of_no_length_leaves_the_whole_of_the_one_before() -> None:
    """Its points replace those from which the rest of the reference would have been worked out."""
    rig, twin = on_path(line(300.0), **NEAR), on_path(line(300.0), **NEAR)
    for one in (rig, twin):
        one.place(100.0, 0.5)
        one.tick()
    assert state_of(rig).first > 0
    rig.path(make_points([0.0, 2e-7, 4e-7], yaw=0.0))
    rig.tick()
    np.testing.assert_array_equal(columns(state_of(rig)), columns(twin.lat))
    rig.place(20.0, -0.5)
    twin.place(20.0, -0.5)
    assert (rig.tick().nearest_idx, rig.status) == (200, twin.status)


# The property: for any path, with garbage where nothing was worked out.


def random_walk(rng: np.random.Generator) -> Values:
    """Headings of a path that bends at random, gently or hard."""
    return np.cumsum(rng.normal(0.0, rng.choice([0.01, 0.1, 0.3]), 200))


def loops(rng: np.random.Generator) -> Values:
    """Several turns over (nearly) the same ground."""
    return np.linspace(0.0, rng.uniform(5.0, 25.0), 200)


def figure_of_eight(rng: np.random.Generator) -> Values:
    """A path that crosses itself in its middle, some times."""
    return 2.4 * np.sin(np.linspace(0.0, 4.0 * math.pi * rng.uniform(0.7, 2.0), 200))


def hairpin(rng: np.random.Generator) -> Values:
    """There, and back beside it."""
    return math.pi / (1.0 + np.exp(-np.linspace(-60.0, 60.0, 200) * rng.uniform(0.3, 2.0)))


def short(rng: np.random.Generator) -> Values:
    """A few points."""
    return np.cumsum(rng.normal(0.0, 0.2, int(rng.integers(3, 9))))


SHAPES = {one.__name__: one for one in (random_walk, loops, figure_of_eight, hairpin, short)}


def random_points(rng: np.random.Generator, shape: str, is_reversed: bool) -> Records:
    """Such a path with uneven steps of 0.05 to 3 m."""
    heading = SHAPES[shape](rng)
    steps = rng.uniform(0.2, 1.5, len(heading)) * rng.choice([0.25, 1.0, 2.0])
    x, y = np.cumsum(steps * np.cos(heading)), np.cumsum(steps * np.sin(heading))
    last = np.append(heading[1:], heading[-1])  # a point faces the next one
    speed = rng.uniform(0.5, 8.0, len(heading))
    sign = -1.0 if is_reversed else 1.0
    points = make_points(x, y, sign * speed, last + (math.pi if is_reversed else 0.0))
    points["z"] = rng.choice([0.0, 1.0]) * np.cumsum(rng.normal(0.0, 0.01, len(heading)))
    return points


def spoil(rig: Rig, value: float) -> None:
    """Put garbage wherever the reference may stand."""
    for name in COLUMNS:
        state_of(rig)[name][:] = value


def nearest_by_hand(rig: Rig, lat: Any, place: tuple[float, float, float]) -> int:
    """The rule of the search, over the whole reference."""
    n, node = int(lat.ref_n), rig.parameters.node
    x, y = lat.rx[: n + 1], lat.ry[: n + 1]
    squared = (x - place[0]) ** 2 + (y - place[1]) ** 2
    if n < 3:
        yaw = lat.short_yaw[np.minimum(np.arange(n + 1), n - 1)]
    else:
        i = np.clip(np.arange(n + 1), 1, n - 2)
        yaw = np.arctan2(y[i + 1] - y[i - 1], x[i + 1] - x[i - 1])
        yaw = yaw if lat.is_forward else yaw + math.pi
    apart = np.abs((yaw - place[2] + math.pi) % (2.0 * math.pi) - math.pi)
    limit = node.ego_nearest_dist_threshold
    for inside in (
        (squared <= limit**2) & (apart <= node.ego_nearest_yaw_threshold),
        squared <= limit**2,
    ):
        if limit > 0.0 and inside.any():
            begin = int(np.argmax(inside))
            end = begin + int(np.argmin(np.append(inside[begin:], False)))
            return begin + int(np.argmin(squared[begin:end]))
    return int(np.argmin(squared[:n]))


def places(rng: np.random.Generator, points: Records) -> list[tuple[float, float, float]]:
    """Poses beside the path: near, at both ends, and far away."""
    found = []
    for spread in (0.1, 0.1, 1.0, 4.0):
        at = points[int(rng.integers(len(points)))]
        yaw = 2.0 * math.atan2(at.qz, at.qw) + rng.normal(0.0, 0.3)
        found.append((at.x + rng.normal(0.0, spread), at.y + rng.normal(0.0, spread), yaw))
    for at in (points[0], points[-1]):
        found.append((at.x + rng.normal(), at.y + rng.normal(), 2.0 * math.atan2(at.qz, at.qw)))
    return found


@pytest.mark.parametrize("is_reversed", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("limits", LIMITS)
@pytest.mark.parametrize("seed", range(3))
def test_any_drive_is_that_of_the_whole_reference(
    seed: int, limits: str, shape: str, is_reversed: bool
) -> None:
    rng = np.random.default_rng([seed, len(shape), is_reversed])
    points = random_points(rng, shape, is_reversed)
    release = "0.53" if seed == 1 else "0.40"  # with and without one-sided ends
    rules: dict[str, Any] = LIMITS[limits] | {
        "enable_deviation_checks": False,
        "autoware_release": release,
        "enable_path_smoothing": seed == 2,
        "input_delay": 0.3,
    }
    rigs = [on_path(points, **rules) for _ in range(2)]
    for place in places(rng, points):
        for rig, garbage in zip(rigs, (math.nan, 1e6), strict=True):
            spoil(rig, garbage)
            rig.place(*place, vx=-2.0 if is_reversed else 2.0)
            rig.tick()
        assert rigs[0].follower.trace.tobytes() == rigs[1].follower.trace.tobytes()
        assert rigs[0].follower.command.tobytes() == rigs[1].follower.command.tobytes()
        lat, whole = state_of(rigs[0]), whole_of(rigs[0])
        low, high = int(lat.first), min(int(lat.ready), int(lat.ref_n) + 1)
        np.testing.assert_array_equal(columns(lat, low, high), columns(whole, low, high))
        if not lat.one_sided_ends:
            assert lat.nearest == nearest_by_hand(rigs[0], whole, place)
