# SPDX-License-Identifier: Apache-2.0
"""What is refused at the gate of the controllers, and with which reason."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.input_check import (
    MAX_ACCELERATION,
    MAX_POSITION,
    MAX_SPEED,
    MAX_TURN,
)
from safety_island.control.records import POINT
from safety_island.control.status import Refusal
from safety_island.kernel.records import Records
from tests.control.lateral_rig import make_points
from tests.golden.harness import firmware

ODOMETRY = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "wz")
POINT_FIELDS = POINT.names[:13]
TURN = ("qx", "qy", "qz", "qw")
BOUNDS = dict.fromkeys(("x", "y", "z"), MAX_POSITION)
BOUNDS |= dict.fromkeys(("v", "v_lat", "vx", "vy"), MAX_SPEED)
BOUNDS |= dict.fromkeys(("wz", "heading_rate", "front_wheel", "rear_wheel"), MAX_TURN)
BOUNDS |= {"acc": MAX_ACCELERATION}
NOT_FINITE = (math.nan, math.inf, -math.inf)
HUGE = (1e300, -1e300, 3e38)


@pytest.fixture(scope="module")
def gate() -> TrajectoryFollower:
    return TrajectoryFollower(firmware())


def road() -> Records:
    return make_points(np.arange(40.0), 0.1 * np.arange(40.0))


def offered(gate: TrajectoryFollower, index: int, **values: float) -> Refusal:
    """The answer to a trajectory with some fields of one point changed."""
    points = road()
    with np.errstate(over="ignore"):  # 1e300 is infinite in a float32
        for name, value in values.items():
            points[name][index] = value
    return gate.offer_trajectory(points, 1000.0)


def odometry(gate: TrajectoryFollower, **values: float) -> Refusal:
    row = dict.fromkeys(ODOMETRY, 0.0) | {"qw": 1.0} | values
    return gate.offer_odometry(*(row[name] for name in ODOMETRY))


@pytest.mark.parametrize("value", NOT_FINITE)
@pytest.mark.parametrize("field", POINT_FIELDS)
def test_a_value_of_a_point_that_is_not_finite(
    gate: TrajectoryFollower, field: str, value: float
) -> None:
    """In every field, in the first point, inside, and in the last."""
    for index in (0, 1, 20, 39):
        assert offered(gate, index, **{field: value}) is Refusal.NOT_FINITE


@pytest.mark.parametrize("value", HUGE)
@pytest.mark.parametrize("field", POINT_FIELDS)
def test_a_value_of_a_point_that_is_huge(
    gate: TrajectoryFollower, field: str, value: float
) -> None:
    reason = Refusal.BAD_QUATERNION if field in TURN else Refusal.OUT_OF_RANGE
    if POINT[field] == np.float32 and abs(value) > 3.5e38:
        reason = Refusal.NOT_FINITE
    for index in (0, 20, 39):
        assert offered(gate, index, **{field: value}) is reason


@pytest.mark.parametrize("field", [name for name in POINT_FIELDS if name not in TURN])
def test_the_bounds_of_a_point(gate: TrajectoryFollower, field: str) -> None:
    beyond = np.nextafter(POINT[field].type(BOUNDS[field]), POINT[field].type(np.inf))
    for sign in (1.0, -1.0):
        assert offered(gate, 20, **{field: sign * beyond}) is Refusal.OUT_OF_RANGE
        wanted = Refusal.TOO_LONG if field in ("x", "y") else Refusal.ACCEPTED
        if field == "v" and sign < 0.0:  # the other points lead forward
            wanted = Refusal.MIXED_DIRECTION
        assert offered(gate, 39, **{field: sign * BOUNDS[field]}) is wanted


@pytest.mark.parametrize("field", POINT_FIELDS)
def test_a_denormal_is_a_number(gate: TrajectoryFollower, field: str) -> None:
    smallest = 1e-45 if POINT[field] == np.float32 else 5e-324
    for value in (smallest, -smallest, -0.0):
        wanted = Refusal.BAD_QUATERNION if field == "qw" else Refusal.ACCEPTED
        points = make_points(np.arange(-20.0, 20.0))
        points[field][20] = value
        assert gate.offer_trajectory(points, 1000.0) is wanted


@pytest.mark.parametrize("value", NOT_FINITE)
@pytest.mark.parametrize("field", ODOMETRY)
def test_a_value_of_the_odometry_that_is_not_finite(
    gate: TrajectoryFollower, field: str, value: float
) -> None:
    assert odometry(gate, **{field: value}) is Refusal.NOT_FINITE


@pytest.mark.parametrize("value", HUGE)
@pytest.mark.parametrize("field", ODOMETRY)
def test_a_value_of_the_odometry_that_is_huge(
    gate: TrajectoryFollower, field: str, value: float
) -> None:
    reason = Refusal.BAD_QUATERNION if field in TURN else Refusal.OUT_OF_RANGE
    assert odometry(gate, **{field: value}) is reason


@pytest.mark.parametrize("field", [name for name in ODOMETRY if name not in TURN])
def test_the_bounds_of_the_odometry(gate: TrajectoryFollower, field: str) -> None:
    for sign in (1.0, -1.0):
        bound = sign * BOUNDS[field]
        assert odometry(gate, **{field: bound}) is Refusal.ACCEPTED
        assert odometry(gate, **{field: math.nextafter(bound, bound * 2)}) is Refusal.OUT_OF_RANGE
        assert odometry(gate, **{field: sign * 5e-324}) is Refusal.ACCEPTED


@pytest.mark.parametrize(
    ("scale", "accepted"), [(0.0, False), (0.989, False), (0.991, True), (1.009, True)]
)
def test_a_quaternion_has_a_norm_of_one_within_a_hundredth(
    gate: TrajectoryFollower, scale: float, accepted: bool
) -> None:
    wanted = Refusal.ACCEPTED if accepted else Refusal.BAD_QUATERNION
    turn = {"qx": 0.5 * scale, "qy": 0.5 * scale, "qz": -0.5 * scale, "qw": 0.5 * scale}
    assert odometry(gate, **turn) is wanted
    assert offered(gate, 7, **turn) is wanted
    assert odometry(gate, qw=1.011) is Refusal.BAD_QUATERNION
    assert offered(gate, 0, qz=0.0, qw=1.011) is Refusal.BAD_QUATERNION


@pytest.mark.parametrize(("norm", "held"), [(1.009, 1.0), (0.991, 1.0), (1.0 + 1e-10, 1.0 + 1e-10)])
def test_a_norm_that_is_nearly_one_becomes_one(
    gate: TrajectoryFollower, norm: float, held: float
) -> None:
    assert odometry(gate, qw=norm) is Refusal.ACCEPTED
    assert gate.inputs["qw"][0] == pytest.approx(held, abs=1e-15)


@pytest.mark.parametrize("value", NOT_FINITE)
def test_steering_acceleration_and_stamp_that_are_not_finite(
    gate: TrajectoryFollower, value: float
) -> None:
    assert gate.offer_steering(value) is Refusal.NOT_FINITE
    assert gate.offer_acceleration(value) is Refusal.NOT_FINITE
    assert gate.offer_trajectory(road(), value) is Refusal.NOT_FINITE


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_bounds_of_steering_and_acceleration(gate: TrajectoryFollower, sign: float) -> None:
    for offer, bound in (
        (gate.offer_steering, MAX_TURN),
        (gate.offer_acceleration, MAX_ACCELERATION),
    ):
        assert offer(sign * bound) is Refusal.ACCEPTED
        assert offer(sign * 5e-324) is Refusal.ACCEPTED
        for huge in (math.nextafter(bound, math.inf), 1e300):
            assert offer(sign * huge) is Refusal.OUT_OF_RANGE


@pytest.mark.parametrize(("mode", "accepted"), [(0, True), (255, True), (-1, False), (256, False)])
def test_the_operation_mode_is_a_byte(gate: TrajectoryFollower, mode: int, accepted: bool) -> None:
    wanted = Refusal.ACCEPTED if accepted else Refusal.OUT_OF_RANGE
    assert gate.offer_operation_mode(mode, True) is wanted
