# SPDX-License-Identifier: Apache-2.0
"""Rows 14 to 19 of the fault catalogue: bytes that are no message, or another one."""

from __future__ import annotations

import math
import tracemalloc
from functools import cache
from random import Random

import numpy as np
import pytest

from safety_island.control.input_check import MAX_ACCELERATION, MAX_POSITION, MAX_SPEED, MAX_TURN
from safety_island.dds import topics
from safety_island.dds.qos import DEFAULT
from safety_island.errors import ConfigurationError
from safety_island.input_gate.reason import SampleReason
from safety_island.life_cycle.reason import Reason
from safety_island.messages import codec
from tests.faults import edit, wire
from tests.faults.checks import BOTH, bound, recovers, silent_within, stays_active
from tests.faults.scene import AGED, INPUTS, SLOW, Scene
from tests.messages.oracle import rosbags_bytes

EACH = pytest.mark.parametrize("key", INPUTS)
SMALL = ("odometry", "steering", "acceleration", "operation_mode")
FLIPS_OF_A_TRAJECTORY = 20_000
POINTS = 100
UNDECODABLE = {
    SampleReason.ENCAPSULATION,
    SampleReason.TRUNCATED,
    SampleReason.LENGTH,
    SampleReason.STRING,
    SampleReason.BOOLEAN,
    SampleReason.TRAILING,
}


class Target:
    """An island that has every input, and one of them once more to be damaged."""

    def __init__(self, key: str, points: int = POINTS) -> None:
        self.scene = Scene()
        cut = edit.points(lambda found: found[:points])
        self.scene.inject(wire.change(cut), "trajectory")
        self.scene.run(0.6)
        sent = self.scene.wires[key].sent[0]
        self.good = cut(sent) if key == "trajectory" else sent
        self.item = self.scene.input(key)
        self._writer = self.scene.wires[key]

    def take(self, data: bytes) -> bool:
        """Let damaged bytes arrive alone; return whether they are accepted."""
        accepted, refused = self.item.accepted, self.item.refused.total()
        self.item.stamps.forget()
        self._writer.release([data])
        self.item.take(self.scene.now, self.scene.now)
        changed = (self.item.accepted - accepted, self.item.refused.total() - refused)
        assert changed in ((1, 0), (0, 1))
        return changed == (1, 0)

    def assert_sane(self) -> None:
        """Whatever was accepted: every number that the controllers hold is within its bound."""
        held = self.scene.follower.inputs[0]
        for names, most in (
            (("x", "y", "z"), MAX_POSITION),
            (("vx", "vy"), MAX_SPEED),
            (("wz", "steer"), MAX_TURN),
            (("ax",), MAX_ACCELERATION),
        ):
            assert all(abs(held[name]) <= most for name in names)
        points = self.scene.follower.points[: held["n_points"]]
        assert np.isfinite(points.view(np.float64).reshape(len(points), -1)[:, :7]).all()
        assert SampleReason.FAULT not in self.item.refused


@EACH
def test_row_14_every_truncation_is_refused(key: str) -> None:
    target = Target(key, points=5)
    for length in range(len(target.good)):
        assert not target.take(target.good[:length]), length
    assert set(target.item.refused) <= UNDECODABLE | {SampleReason.TOO_FEW_POINTS}
    assert target.take(target.good)


@BOTH
@pytest.mark.parametrize("key", AGED)
def test_row_14_a_stream_of_truncated_messages_ages_out(key: str, period_s: float) -> None:
    scene = Scene(period_s).drive()
    since = scene.inject(wire.change(lambda data: data[:-1]), key)
    silent_within(scene, since, bound(key, period_s))
    assert scene.refused(key, SampleReason.TRUNCATED) > 0
    recovers(scene, Reason.INPUT_STALE)


@EACH
def test_row_15_flipped_bits_are_refused_or_within_bounds(key: str, random: Random) -> None:
    """Every bit of the small messages, a sample of those of a trajectory of 100 points."""
    target = Target(key)
    bits: list[int] = list(range(8 * len(target.good)))
    if key == "trajectory":
        bits = random.sample(bits, FLIPS_OF_A_TRAJECTORY)
    for bit in bits:
        data = bytearray(target.good)
        data[bit // 8] ^= 1 << bit % 8
        if target.take(bytes(data)) and key != "operation_mode":
            target.assert_sane()
    assert SampleReason.FAULT not in target.item.refused


@pytest.mark.parametrize("share", [0.01, 0.1, 1.0])
def test_row_15_a_drive_with_flipped_bits_stays_finite(share: float, random: Random) -> None:
    """Whatever passes for a message, no tick fails and no command holds a number that is none."""
    scene = Scene().drive()

    def flip(data: bytes) -> bytes:
        if random.random() >= share:
            return data
        changed = bytearray(data)
        changed[random.randrange(4, len(data))] ^= 1 << random.randrange(8)
        return bytes(changed)

    scene.inject(wire.change(flip), *AGED)
    for row in scene.run(60.0):
        assert row.outcome.name != "FAULT"
        assert row.command is None or math.isfinite(sum(row.command[2:7]))
        if row.output == "silent":
            scene.disengage()
    scene.clear()
    scene.run(1.0)
    scene.disengage()
    scene.run(1.0)
    stays_active(scene, 1.0)


@EACH
@pytest.mark.parametrize("length", [2**31 - 1, 2**31, 2**32 - 1])
def test_row_16_an_endless_length_is_refused_without_memory(key: str, length: int) -> None:
    target = Target(key)
    tracemalloc.start()
    try:
        for at in range(12, min(40, len(target.good) - 4), 4):
            data = bytearray(target.good)
            data[at : at + 4] = length.to_bytes(4, "little")
            target.take(bytes(data))
        assert tracemalloc.get_traced_memory()[1] < 300_000
    finally:
        tracemalloc.stop()
    if key == "trajectory":
        assert (
            target.item.refused[SampleReason.LENGTH] + target.item.refused[SampleReason.TRUNCATED]
            > 0
        )


def test_row_17_a_trajectory_that_lost_a_fragment_is_a_lost_one() -> None:
    """DDS delivers whole samples only (tests/dds/test_hostile.py); small ones still come."""
    scene = Scene().drive()
    since = scene.inject(lambda data: [] if len(data) > 1400 else [(0.0, data)])
    silent_within(scene, since, bound("trajectory", SLOW))
    assert scene.rows[-1].reason is Reason.INPUT_STALE
    recovers(scene, Reason.INPUT_STALE)


@EACH
def test_row_18_another_type_on_a_topic_is_told(key: str) -> None:
    """In memory at once; over DDS within the time of discovery (test_malformed_live.py)."""
    scene, entry = Scene(), topics.topic(key)
    with pytest.raises(ConfigurationError, match=f"topic '{entry.name}' has the type"):
        scene.domain.publisher(entry.name, "tier4_debug_msgs/msg/Float64Stamped", DEFAULT)
    scene.drive()


@cache
def big_endian(key: str, data: bytes) -> bytes:
    """Return the same message in the other byte order, by an independent serializer."""
    name = topics.topic(key).type_name
    return rosbags_bytes(name, codec.decode(name, data), little_endian=False)


@EACH
def test_row_19_big_endian_messages_are_read(key: str) -> None:
    twin, scene = Scene().drive(), Scene().drive()
    scene.inject(wire.change(lambda data: big_endian(key, data)), key)
    if key == "operation_mode":
        for one in (scene, twin):
            one.disengage()
            one.tick()
    assert stays_active(scene, 1.0) == stays_active(twin, 1.0)
    assert scene.input(key).accepted == twin.input(key).accepted


@EACH
@pytest.mark.parametrize("kind", [2, 3, 6, 7, 8, 9, 10, 11, 0x1234])
def test_row_19_other_encapsulations_are_refused(key: str, kind: int) -> None:
    target = Target(key)
    assert not target.take(kind.to_bytes(2, "big") + target.good[2:])
    assert set(target.item.refused) == {SampleReason.ENCAPSULATION}
    assert target.take(target.good)
