# SPDX-License-Identifier: Apache-2.0
"""Rows 14 to 19 with real bytes through real DDS: the island survives, counts, and goes on.

The node is in this process, on virtual time, over a participant of its own; what comes to it has
passed the network stack of DDS. Forged datagrams, missing fragments and big endian:
tests/dds/test_hostile.py.
"""

from __future__ import annotations

from contextlib import suppress
from random import Random

import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.dds import topics
from safety_island.dds.raw_topic import OpaqueTopic
from safety_island.dds.topics import TopicEntry
from safety_island.input_gate.reason import SampleReason
from safety_island.node.controller import ControllerNode
from safety_island.node.report import TickReport
from safety_island.params import load_set
from safety_island.platform.sim import make
from safety_island.sim.courses import load_course
from safety_island.sim.main_compute import MainCompute
from safety_island.sim.world import World
from tests.dds.conftest import NewParticipant
from tests.dds.waiting import wait_for

pytestmark = pytest.mark.live
AGED = tuple(entry for entry in topics.INPUTS if entry.age_limit)
EACH = pytest.mark.parametrize("entry", AGED, ids=lambda entry: entry.key)
PERIOD_NS = 150_000_000
SHORT_S = 0.03
CUTS = 30


class Live:
    """A node over DDS, a main compute that feeds it, and a hand on one of its publishers."""

    def __init__(self, make_participant: NewParticipant, entry: TopicEntry) -> None:
        self.platform = make()
        self.clock = self.platform.clock
        parameters = load_set("default")
        follower = TrajectoryFollower(parameters)
        island, other = make_participant(), make_participant("main_compute")
        for one in topics.INPUTS:  # whatever is written, no type stands in the way
            name = ("rt" + one.name, one.type_name)
            other._topics[name] = OpaqueTopic(other.handle, *name)
        self.node = ControllerNode(self.platform, island, follower, parameters)
        world = World(load_course("s-curve"), 1000.0)
        self.main_compute = MainCompute(world, other, self.clock)
        self.publisher = getattr(self.main_compute, f"_{entry.key}")
        self.item = next(item for item in self.node.inputs.items if item.topic == entry.name)
        self.sent = b""
        write = self.publisher.write

        def keep(data: bytes) -> bool:
            self.sent = data
            return bool(write(data))

        self.publisher.write = keep
        self.write = write
        wait_for(self.is_running)

    def is_running(self) -> bool:
        """Whether a command goes out, after one more round."""
        return self.round().published

    def round(self, *damaged: bytes) -> TickReport:
        """Publish everything, then the damaged bytes, and tick when they have arrived."""
        self.clock.advance_to_ns(self.clock.monotonic_ns() + PERIOD_NS)
        self.main_compute.publish_vehicle()
        self.main_compute.publish_plan()
        for data in damaged:
            self.write(data)
        return self.node.tick()

    def takes(self, data: bytes) -> bool:
        """Let damaged bytes arrive alone, and say whether the island took them.

        What DDS itself refuses, at the writer or the reader, does not arrive at all.
        """
        accepted, refused = self.item.accepted, self.item.refused.total()
        self.item.stamps.forget()  # a stamp is no reason to refuse it
        if not self.write(data):
            return False

        def judged() -> int:
            now = self.clock.monotonic_ns() / 1e9
            self.node.inputs.take(now, now)
            return self.item.accepted - accepted + self.item.refused.total() - refused

        with suppress(AssertionError):
            wait_for(judged, SHORT_S)
        return self.item.accepted > accepted

    def goes_on(self) -> None:
        """The next good messages give the next command; no tick has failed."""
        wait_for(self.is_running)
        assert SampleReason.FAULT not in self.item.refused
        assert not [line for line in self.platform.logger.lines if "the tick failed" in line]


@EACH
def test_row_14_truncated_bytes(entry: TopicEntry, participant: NewParticipant) -> None:
    """Cuts in steps of four bytes, as RTPS pads."""
    live = Live(participant, entry)
    data = live.sent
    for length in range(4, len(data) - 4, max(4, len(data) // CUTS // 4 * 4)):
        assert not live.takes(data[:length]), length
    live.goes_on()


@EACH
def test_row_15_flipped_bits(
    entry: TopicEntry, participant: NewParticipant, random: Random
) -> None:
    live = Live(participant, entry)
    for _ in range(60):
        data = bytearray(live.sent)
        data[random.randrange(12, len(data))] ^= 1 << random.randrange(8)
        live.takes(bytes(data))
        live.round()
    live.goes_on()


@pytest.mark.parametrize("length", [2**31 - 1, 2**31, 2**32 - 1])
@pytest.mark.parametrize("at", [12, 20])
def test_row_16_an_endless_length(participant: NewParticipant, length: int, at: int) -> None:
    live = Live(participant, topics.TRAJECTORY)
    data = bytearray(live.sent)
    data[at : at + 4] = length.to_bytes(4, "little")
    assert not live.takes(bytes(data))
    live.goes_on()


@EACH
def test_row_18_a_writer_of_another_type(entry: TopicEntry, participant: NewParticipant) -> None:
    """It never matches, so it is no second publisher, nothing of it arrives, and it is told."""
    live = Live(participant, entry)
    other = participant("wrong_type")
    wrong = "tier4_debug_msgs/msg/Float64Stamped"
    publisher = other.publisher(entry.name, wrong)
    before = live.item.subscription.received
    for _ in range(5):
        publisher.write(bytes(20))
        live.round()
    assert publisher.matched() == 0
    assert live.item.subscription.received >= before
    told = f"{publisher.guid.hex()} has type {wrong}, expected {entry.type_name}"

    def is_told() -> bool:
        live.round()
        return any(f"{entry.name}: publisher {told}" in line for line in live.platform.logger.lines)

    wait_for(is_told)
    live.goes_on()


@EACH
def test_row_19_other_encapsulations(entry: TopicEntry, participant: NewParticipant) -> None:
    live = Live(participant, entry)
    for kind in (2, 3, 6, 7, 8, 9, 10, 11):
        assert not live.takes(kind.to_bytes(2, "big") + live.sent[2:]), kind
    assert set(live.item.refused) <= {SampleReason.ENCAPSULATION}
    live.goes_on()
