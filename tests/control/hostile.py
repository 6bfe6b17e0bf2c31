# SPDX-License-Identifier: Apache-2.0
"""Inputs that must be refused: every field of every message, each as its own case."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.limits import MAX_POINTS
from safety_island.control.records import POINT
from safety_island.control.status import Refusal
from safety_island.kernel.records import Records
from tests.control.lateral_rig import make_points

Offer = Callable[[TrajectoryFollower], Refusal]
ODOMETRY = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "wz")
VALUES = (math.nan, math.inf, -math.inf, 1e300, -1e300)
ROAD = make_points(np.arange(30.0))


def _odometry(name: str, value: float) -> Offer:
    row = dict.fromkeys(ODOMETRY, 0.0) | {"qw": 1.0} | {name: value}
    return lambda follower: follower.offer_odometry(*row.values())


def _single(offer: str, value: float) -> Offer:
    return lambda follower: Refusal(getattr(follower, offer)(value))


def _trajectory(points: Records, stamp: float = 1000.0) -> Offer:
    return lambda follower: follower.offer_trajectory(points, stamp)


def _with(field: str, value: float, index: int) -> Records:
    points = ROAD.copy()
    with np.errstate(over="ignore"):
        points[field][index] = value
    return points


def _one_place() -> Records:
    points = ROAD.copy()
    points[:] = points[10]
    return points


def cases() -> Iterator[tuple[str, Offer]]:
    """Each hostile input with a name."""
    for value in VALUES:
        for name in ODOMETRY:
            yield f"odometry {name} {value}", _odometry(name, value)
        for field in POINT.names[:13]:
            for index in (0, 15, 29):
                points = _with(field, value, index)
                yield f"point {index} {field} {value}", _trajectory(points)
        yield f"steering {value}", _single("offer_steering", value)
        yield f"ax {value}", _single("offer_acceleration", value)
        if not math.isfinite(value):
            yield f"stamp {value}", _trajectory(ROAD, value)
    yield "zero quaternion", _odometry("qw", 0.0)
    yield "long quaternion", _odometry("qz", 1.0)
    yield "zero quaternion of a point", _trajectory(_with("qw", 0.0, 3))
    yield "no points", _trajectory(ROAD[:0])
    yield "one point", _trajectory(ROAD[:1])
    yield "all points at one place", _trajectory(_one_place())
    yield "to and fro", _trajectory(np.concatenate([ROAD, ROAD[::-1]]))
    yield "too many points", _trajectory(make_points(np.arange(MAX_POINTS + 1) * 0.1))
    yield "too long", _trajectory(make_points(np.linspace(0.0, 1e6, 50)))
    yield "no such count", lambda follower: follower.offer_incoming(-5, 1000.0)
    yield "no such mode", lambda follower: follower.offer_operation_mode(300, True)
