# SPDX-License-Identifier: Apache-2.0
"""Bad samples through the real node and controllers: nothing changes but the counters."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.limits import MAX_POINTS
from safety_island.control.records import POINT
from safety_island.dds import topics
from safety_island.dds.topics import TopicEntry
from safety_island.input_gate.reason import SampleReason
from safety_island.messages.inputs import (
    Acceleration,
    Odometry,
    Steering,
    encode_acceleration,
    encode_odometry,
    encode_steering,
)
from safety_island.messages.outputs import Control
from safety_island.messages.trajectory import encode_trajectory
from safety_island.messages.wire import Time
from safety_island.node.report import Outcome
from safety_island.params import load_set
from tests.node.rig import FakeFollower, Point, Rig, make_points

ROWS: list[Point] = [(x - 5.0, 0.3 * math.sin(0.1 * x), 3.0) for x in range(60)]
STAMP = Time(1000, 0)
TICKS = 12
BAD_TICK = 6

USED = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "wz")
POINT_FIELDS = POINT.names[:13]


def odometry(**changes: float) -> bytes:
    values = dict.fromkeys(Odometry._fields[3:], 0.0) | {"vx": 3.0, "qw": 1.0} | changes
    return encode_odometry(Odometry(STAMP, "map", "base_link", **values))


def trajectory(field: str, value: float) -> bytes:
    points = make_points(ROWS)
    points[field][20] = value
    return encode_trajectory(STAMP, "map", points)


def bad_samples() -> dict[str, tuple[TopicEntry, bytes]]:
    """Samples that must be refused, by name."""
    good = {topics.ODOMETRY: odometry(), topics.TRAJECTORY: trajectory("v", 3.0)}
    found: dict[str, tuple[TopicEntry, bytes]] = {}
    for value in (math.nan, math.inf, -math.inf, 1e30):
        for name in USED:
            found[f"odometry {name} {value}"] = topics.ODOMETRY, odometry(**{name: value})
        for name in POINT_FIELDS:
            found[f"point {name} {value}"] = topics.TRAJECTORY, trajectory(name, value)
        found[f"steering {value}"] = topics.STEERING, encode_steering(Steering(STAMP, value))
        acceleration = Acceleration(STAMP, "base_link", value, *[0.0] * 5)
        found[f"acceleration {value}"] = topics.ACCELERATION, encode_acceleration(acceleration)
    found["no rotation"] = topics.ODOMETRY, odometry(qw=0.0)
    found["not a unit quaternion"] = topics.ODOMETRY, odometry(qw=1.1)
    rows = [(0.01 * i, 0.0, 1.0) for i in range(MAX_POINTS + 1)]
    found["too many points"] = topics.TRAJECTORY, encode_trajectory(STAMP, "map", make_points(rows))
    for entry, data in good.items():
        for length in (0, 1, 4, 12, len(data) // 2, len(data) - 8):
            found[f"{entry.key} cut to {length}"] = entry, data[:length]
        found[f"{entry.key} as XCDR2"] = entry, b"\x00\x07" + data[2:]
        found[f"{entry.key} with a tail"] = entry, data + bytes(8)
    at = good[topics.TRAJECTORY].index(struct.pack("<I", len(ROWS)))
    endless = bytearray(good[topics.TRAJECTORY])
    endless[at : at + 4] = b"\xff\xff\xff\xff"
    found["endless trajectory"] = topics.TRAJECTORY, bytes(endless)
    return found


BAD = {name: sample for name, sample in bad_samples().items() if name != "steering 1e+30"}


@pytest.fixture(scope="module")
def drive() -> Callable[[tuple[TopicEntry, bytes] | None], list[Control | None]]:
    """Drives a fresh node for some ticks, with a bad sample in one of them, or without."""
    parameters = load_set("firmware")

    def run(bad: tuple[TopicEntry, bytes] | None) -> list[Control | None]:
        rig = Rig(TrajectoryFollower(parameters))
        commands = []
        for tick in range(TICKS):
            if tick != BAD_TICK:
                rig.everything(ROWS, vx=2.5 + 0.05 * tick, steer=0.01 * tick)
            elif bad is not None:
                rig.send(*bad)
            report = rig.tick()
            assert report.outcome is Outcome.PUBLISHED
            assert report.refused == (tick == BAD_TICK and bad is not None)
            commands.append(rig.command())
        return commands

    return run


@pytest.mark.parametrize("name", BAD)
def test_a_refused_sample_changes_no_command(
    drive: Callable[[tuple[TopicEntry, bytes] | None], list[Control | None]],
    undisturbed: list[Control | None],
    name: str,
) -> None:
    assert drive(BAD[name]) == undisturbed


@pytest.fixture(scope="module")
def undisturbed(
    drive: Callable[[tuple[TopicEntry, bytes] | None], list[Control | None]],
) -> list[Control | None]:
    """The commands of a drive without a bad sample."""
    return drive(None)


@settings(max_examples=300, suppress_health_check=[HealthCheck.too_slow])
@given(
    entry=st.sampled_from(topics.INPUTS),
    data=st.binary(max_size=300) | st.binary(max_size=300).map(lambda rest: b"\0\1\0\0" + rest),
)
def test_random_bytes_are_refused_or_decoded_and_never_a_fault(
    entry: TopicEntry, data: bytes
) -> None:
    rig = Rig(FakeFollower())
    rig.send(entry, data)
    report = rig.tick()
    assert report.outcome is Outcome.WAITING_FOR_INPUT
    reasons = [reason for item in rig.node.inputs.items for reason in item.refused]
    assert SampleReason.FAULT not in reasons
    assert report.refused == len(reasons)


@settings(max_examples=300, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_flipped_bits_are_never_a_fault(data: st.DataObject) -> None:
    sample = bytearray(data.draw(st.sampled_from([odometry(), trajectory("v", 1.0)])))
    for bit in data.draw(st.lists(st.integers(0, 8 * len(sample) - 1), min_size=1, max_size=20)):
        sample[bit // 8] ^= 1 << bit % 8
    rig = Rig(FakeFollower())
    for entry in (topics.ODOMETRY, topics.TRAJECTORY):
        rig.send(entry, bytes(sample))
    assert rig.tick().outcome is Outcome.WAITING_FOR_INPUT
    assert all(SampleReason.FAULT not in item.refused for item in rig.node.inputs.items)
