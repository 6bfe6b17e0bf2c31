# SPDX-License-Identifier: Apache-2.0
"""Rows 20 to 26 of the fault catalogue: values, orientations, frames and sizes that are wrong."""

from __future__ import annotations

import math
import time
import tracemalloc
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from safety_island.control.records import POINT
from safety_island.input_gate.reason import SampleReason
from safety_island.kernel.records import Records
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.inputs import decode_odometry
from safety_island.messages.trajectory import encode_trajectory
from safety_island.messages.wire import Time
from tests.faults import edit, wire
from tests.faults.checks import bound, recovers, silent_within, stays_active
from tests.faults.edit import Edit
from tests.faults.scene import SLOW, Row, Scene

JUST_BEFORE = {"trajectory": 0.09}
"""How long after a tick [s] the next message of a topic is the newest one of the tick after."""


def disturbed(key: str, fault: wire.Fault) -> tuple[Scene, list[Row]]:
    """Drive, let the fault meet the one message that a tick would use, and drive on."""
    scene = Scene().drive()
    scene.idle(JUST_BEFORE.get(key, 0.14))
    scene.inject(wire.once(fault), key)
    return scene, stays_active(scene, 1.5)


@cache
def without(key: str) -> list[Row]:
    """The ticks of a drive that lost the message that others find bad."""
    return disturbed(key, wire.drop)[1]


def is_refused(key: str, change: Edit, *reasons: SampleReason) -> None:
    """One bad message: counted once, no trace in any command, accepted again at once."""
    scene, rows = disturbed(key, wire.change(change))
    assert rows == without(key)
    counted = scene.input(key).refused
    assert counted.total() == 1
    assert set(counted) <= set(reasons), counted


QUATERNION = ("qx", "qy", "qz", "qw")
NOT_FINITE = {
    f"{name}={value}": found
    for value in (math.nan, math.inf, -math.inf)
    for name, found in edit.one_value(value).items()
}
HUGE = {
    f"{name}={value}": found
    for value in (1e30, -1e30)
    for name, found in edit.one_value(value).items()
}
TINY = {
    name: found
    for name, found in edit.one_value(1e-310).items()
    if name.rsplit(".", 1)[-1] not in (*QUATERNION, "x", "y")
} | {"steering": ("steering", edit.steering(1e-40))}
"""Where zero would be no fault: in a place or an orientation it is another row."""


@pytest.mark.parametrize("name", NOT_FINITE)
def test_row_20_a_number_that_is_none_is_refused(name: str) -> None:
    is_refused(*NOT_FINITE[name], SampleReason.NOT_FINITE)


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e300])
def test_row_20_what_nobody_uses_is_ignored(value: float) -> None:
    twin, scene = Scene().drive(), Scene().drive()
    scene.inject(
        wire.change(edit.odometry(**dict.fromkeys(edit.UNUSED_ODOMETRY, value))), "odometry"
    )
    other = edit.acceleration(**dict.fromkeys(edit.UNUSED_ACCELERATION, value))
    scene.inject(wire.change(other), "acceleration")
    assert stays_active(scene, 1.5) == stays_active(twin, 1.5)
    for key, change in edit.covariances(value).items():
        scene.inject(wire.change(change), key)
    assert stays_active(scene, 1.5) == stays_active(twin, 1.5)


def test_row_20_a_stream_of_them_ends_the_output() -> None:
    scene = Scene().drive()
    since = scene.inject(wire.change(edit.odometry(vx=math.nan)), "odometry")
    silent_within(scene, since, bound("odometry", SLOW))
    recovers(scene, Reason.INPUT_STALE)


@pytest.mark.parametrize("name", HUGE)
def test_row_21_a_huge_number_is_refused(name: str) -> None:
    is_refused(*HUGE[name], SampleReason.OUT_OF_RANGE, SampleReason.BAD_QUATERNION)


@pytest.mark.parametrize("name", TINY)
def test_row_21_a_subnormal_number_is_the_zero_that_it_is(name: str) -> None:
    """A filter that decays at standstill makes such numbers, so they are accepted."""
    key, change = TINY[name]
    scene, rows = disturbed(key, wire.change(change))
    assert not scene.input(key).refused
    assert all(is_finite(row) for row in rows)


def is_finite(row: Row) -> bool:
    """Whether every number of a command is one."""
    assert row.command is not None
    return math.isfinite(sum(row.command[2:7]))


def turned(norm: float) -> dict[str, tuple[str, Edit]]:
    """Edits that scale an orientation."""

    def scale(data: bytes) -> bytes:
        message = decode_odometry(data)
        return edit.odometry(**{n: getattr(message, n) * norm for n in QUATERNION})(data)

    def scale_points(points: Records) -> None:
        for name in QUATERNION:
            points[name][3] *= norm

    return {"odometry": ("odometry", scale), "point": ("trajectory", edit.points(scale_points))}


@pytest.mark.parametrize("norm", [0.0, 0.5, 0.98, 1.02, 2.0])
@pytest.mark.parametrize("name", ["odometry", "point"])
def test_row_22_no_unit_quaternion_is_refused(name: str, norm: float) -> None:
    is_refused(*turned(norm)[name], SampleReason.BAD_QUATERNION)


@pytest.mark.parametrize("norm", [0.995, 1.005])
@pytest.mark.parametrize("name", ["odometry", "point"])
def test_row_22_a_rounded_quaternion_is_normalised(name: str, norm: float) -> None:
    key, change = turned(norm)[name]
    scene, rows = disturbed(key, wire.change(change))
    assert not scene.input(key).refused
    for row, twin in zip(rows, disturbed(key, wire.healthy)[1], strict=True):
        assert row.command is not None and twin.command is not None
        assert row.command[2:7] == pytest.approx(twin.command[2:7], abs=1e-2)


@pytest.mark.parametrize("frame", ["base_link", "odom", "Map", ""])
def test_row_23_a_foreign_frame_is_refused(frame: str) -> None:
    is_refused("odometry", edit.odometry(frame_id=frame), SampleReason.WRONG_FRAME)
    is_refused("odometry", edit.odometry(child_frame_id="map"), SampleReason.WRONG_FRAME)
    if frame:
        same = edit.points(lambda points: None, frame)
        is_refused("trajectory", same, SampleReason.WRONG_FRAME)
    if frame != "base_link":
        change = edit.acceleration(frame_id=frame)
        is_refused("acceleration", change, SampleReason.WRONG_FRAME)


def cut(count: int) -> Edit:
    """Leave that many points of a trajectory."""
    return edit.points(lambda points: points[:count])


def test_row_24_an_empty_trajectory_gives_no_command() -> None:
    scene = Scene(absent=["trajectory"])
    scene.inject(wire.change(cut(0)), "trajectory")
    scene.wires["trajectory"].restart()
    assert {(row.state, row.output) for row in scene.run(5.0)} == {(State.INIT, "silent")}
    assert scene.refused("trajectory", SampleReason.TOO_FEW_POINTS) > 0
    scene.clear()
    scene.run(0.6)
    stays_active(scene, 1.0)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_row_25_too_few_points_leave_the_old_path_until_it_is_too_old(count: int) -> None:
    """Row 24 too, for a vehicle that drives."""
    scene = Scene().drive()
    since = scene.inject(wire.change(cut(count)), "trajectory")
    rows = stays_active(scene, 0.6)
    assert rows[-1].at > since
    silent_within(scene, since, bound("trajectory", SLOW))
    assert set(scene.input("trajectory").refused) == {SampleReason.TOO_FEW_POINTS}
    recovers(scene, Reason.INPUT_STALE)


@pytest.fixture(scope="module")
def endless() -> Callable[[int], bytes]:
    """Makes a trajectory of any number of points, once for each."""

    @cache
    def make(count: int) -> bytes:
        points = np.zeros(count, POINT)
        points["x"], points["qw"], points["v"] = 0.001 * np.arange(count), 1.0, 5.0
        return encode_trajectory(Time(2000, 0), "map", points)

    return make


@pytest.mark.parametrize("count", [4097, 10_000, 1_000_000])
def test_row_26_too_many_points_cost_neither_time_nor_memory(
    endless: Callable[[int], bytes], count: int
) -> None:
    data = endless(count)
    scene = Scene().drive()
    scene.inject(wire.change(lambda _: data), "trajectory")
    begin = time.perf_counter()
    row = scene.tick()
    assert time.perf_counter() - begin < SLOW / 2
    assert row.state is State.ACTIVE
    tracemalloc.start()
    try:
        stays_active(scene, 0.3)
        assert tracemalloc.get_traced_memory()[1] < 500_000
    finally:
        tracemalloc.stop()
    reasons = {SampleReason.LENGTH, SampleReason.TOO_MANY_POINTS}
    assert set(scene.input("trajectory").refused) <= reasons
    silent_within(scene, scene.now - 0.45, bound("trajectory", SLOW))
    recovers(scene, Reason.INPUT_STALE)
