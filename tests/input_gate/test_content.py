# SPDX-License-Identifier: Apache-2.0
"""Frames, the number of points, and odometry that repeats."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from safety_island.input_gate.content import ContentGate
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.stamps import StampGate
from safety_island.messages.inputs import Acceleration, Odometry
from safety_island.messages.points import POINT
from safety_island.messages.trajectory import Trajectory
from safety_island.messages.wire import Time
from tests.input_gate.parameters import PARAMETERS

GATE = ContentGate(PARAMETERS)
STAMPS = StampGate(0.5)
OLD = bytes(12) + b"said before"
STAMP = Time(1, 0)


def trajectory(frame: str, points: int) -> Trajectory:
    return Trajectory(STAMP, frame, np.zeros(points, POINT), Time())


def odometry(frame: str = "map", child: str = "base_link", vx: float = 0.0) -> Odometry:
    values = dict.fromkeys(Odometry._fields[3:], 0.0) | {"qw": 1.0, "vx": vx}
    return Odometry(STAMP, frame, child, **values)


@pytest.fixture
def holding() -> StampGate:
    """Stamps of an input that holds OLD."""
    stamps = StampGate(0.5)
    assert stamps.judge(STAMP, OLD, 1.0) is None
    stamps.hold(OLD, 1.0)
    return stamps


@pytest.mark.parametrize(
    ("frame", "points", "reason"),
    [
        ("map", 3, None),
        ("/map", 4, None),
        ("map", 2, SampleReason.TOO_FEW_POINTS),
        ("map", 0, SampleReason.TOO_FEW_POINTS),
        ("base_link", 3, SampleReason.WRONG_FRAME),
        ("", 0, SampleReason.WRONG_FRAME),
    ],
)
def test_a_trajectory(frame: str, points: int, reason: SampleReason | None) -> None:
    assert GATE.trajectory(trajectory(frame, points), b"", STAMPS) is reason


@pytest.mark.parametrize(
    ("frame", "child", "fits"),
    [
        ("map", "base_link", True),
        ("/map", "/base_link", True),
        ("odom", "base_link", False),
        ("map", "map", False),
        ("base_link", "map", False),
    ],
)
def test_both_frames_of_an_odometry(frame: str, child: str, fits: bool) -> None:
    reason = None if fits else SampleReason.WRONG_FRAME
    assert GATE.odometry(odometry(frame, child), b"", STAMPS) is reason


@pytest.mark.parametrize("vx", [0.125, -0.125, 5.0])
def test_a_moving_vehicle_cannot_repeat_its_odometry(holding: StampGate, vx: float) -> None:
    again = b"new header ." + OLD[12:]
    assert GATE.odometry(odometry(vx=vx), again, holding) is SampleReason.FROZEN
    assert GATE.odometry(odometry(vx=vx), again + b"!", holding) is None


@pytest.mark.parametrize("vx", [0.0, 0.1249, -0.1249])
def test_a_standing_one_can(holding: StampGate, vx: float) -> None:
    assert GATE.odometry(odometry(vx=vx), OLD, holding) is None


@pytest.mark.parametrize(
    ("frame", "fits"), [("map", True), ("base_link", True), ("/base_link", True), ("imu", False)]
)
def test_an_acceleration_in_either_frame(frame: str, fits: bool) -> None:
    message = Acceleration(STAMP, frame, *[0.0] * 6)
    reason = None if fits else SampleReason.WRONG_FRAME
    assert GATE.acceleration(message, b"", STAMPS) is reason


def test_frames_that_are_not_looked_at() -> None:
    gate = ContentGate(replace(PARAMETERS, map_frame="", base_frame=""))
    assert gate.trajectory(trajectory("odom", 3), b"", STAMPS) is None
    assert gate.odometry(odometry("odom", "wheel"), b"", STAMPS) is None
    assert gate.acceleration(Acceleration(STAMP, "imu", *[0.0] * 6), b"", STAMPS) is None
