# SPDX-License-Identifier: Apache-2.0
"""Damaged messages through real DDS: rows 14 to 16 and 19 of the fault catalogue.

Two ways in: a writer that checks nothing (same process), and forged RTPS datagrams in the name of a
real writer of another process. Whatever comes out of the subscription is then decoded.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import pytest

from safety_island.control.records import new_points
from safety_island.dds import topics
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.qos import DEFAULT
from safety_island.dds.raw_topic import OpaqueTopic
from safety_island.dds.topics import TopicEntry
from safety_island.kernel.cdr import DecodeReason
from safety_island.messages import inputs
from safety_island.messages.errors import DecodeError
from safety_island.messages.trajectory import decode_trajectory
from safety_island.messages.wire import Time
from tests.dds.conftest import NewParticipant
from tests.dds.peer import line, peer
from tests.dds.rtps import Forger
from tests.dds.waiting import wait_for
from tests.messages.samples import hot_messages, trajectory_bytes

DEEP = DEFAULT.with_depth(256)
DATA = {hot.name: hot.data for hot in hot_messages(100)}
DECODE = {hot.name: hot.decode for hot in hot_messages(0)}
NO_ENCAPSULATION = 0xFFFF
"""So far from any that the network layer refuses the datagram."""
each_input = pytest.mark.parametrize("entry", topics.INPUTS, ids=lambda entry: entry.key)


class Channel:
    """An unchecked writer and the island's own subscription on one topic."""

    def __init__(self, make: NewParticipant, entry: TopicEntry) -> None:
        other = make("attacker")
        name = ("rt" + entry.name, entry.type_name)
        other._topics[name] = OpaqueTopic(other.handle, *name)
        self.publisher: Publisher = other.publisher(entry.name, entry.type_name)
        self.subscription: Subscription = make().subscription(entry.name, entry.type_name, DEEP)
        self.decode: Callable[[bytes], Any] = DECODE[entry.type_name]
        self.good = DATA[entry.type_name]
        wait_for(self.publisher.matched)
        wait_for(self.subscription.matched)

    def through(self, data: bytes) -> list[bytes]:
        """Write damaged data, then good data; return what was received before the good ones."""
        self.publisher.write(data)
        self.publisher.write(self.good)
        return self.until_good()

    def until_good(self) -> list[bytes]:
        wanted = self.good + bytes(-len(self.good) % 4)
        found: list[bytes] = []
        while True:
            sample = wait_for(lambda: self.subscription.take_all() or None)
            found += [one.data for one in sample]
            if found[-1] == wanted:
                return found[:-1]

    def decoded(self, data: bytes) -> int:
        """Return how many of the received samples decode; the others are refused in order."""
        count = 0
        for received in self.through(data):
            try:
                self.decode(received)
                count += 1
            except DecodeError:
                pass
        return count


@pytest.fixture
def channel(participant: NewParticipant) -> Callable[[TopicEntry], Channel]:
    return lambda entry: Channel(participant, entry)


@each_input
def test_truncated(entry: TopicEntry, channel: Callable[[TopicEntry], Channel]) -> None:
    """Every cut of a small message, cuts all over a large one; 4-byte steps, as RTPS pads."""
    way = channel(entry)
    step = 4 if len(way.good) < 1000 else 84
    for k in range(4, len(way.good) - 4, step):
        assert way.decoded(way.good[:k]) == 0, k
    assert way.decoded(way.good) == 1


@each_input
def test_bit_flips(entry: TopicEntry, channel: Callable[[TopicEntry], Channel]) -> None:
    way = channel(entry)
    bits = range(len(way.good) * 8)
    seeded = random.Random(3)
    for bit in seeded.sample(bits, min(400, len(bits))):
        data = bytearray(way.good)
        data[bit // 8] ^= 1 << bit % 8
        assert way.decoded(bytes(data)) <= 1


@pytest.mark.parametrize("length", [4, 101, 2**16, 2**31 - 1, 2**31, 2**32 - 1])
def test_absurd_lengths(length: int, channel: Callable[[TopicEntry], Channel]) -> None:
    way = channel(topics.TRAJECTORY)
    assert way.good[20:24] == (100).to_bytes(4, "little")
    for place in (12, 20):
        data = bytearray(way.good)
        data[place : place + 4] = length.to_bytes(4, "little")
        assert way.decoded(bytes(data)) == (1 if data == way.good else 0)


@pytest.mark.parametrize("kind", [2, 3, 6, 7, 8, 9, 10, 11, 0x1234])
@each_input
def test_other_encapsulations(
    kind: int, entry: TopicEntry, channel: Callable[[TopicEntry], Channel]
) -> None:
    way = channel(entry)
    assert way.decoded(kind.to_bytes(2, "big") + way.good[2:]) == 0


@pytest.mark.parametrize(
    ("count", "found"),
    [(4150, "4150 points, at most 4096"), (20_000, "1760028 bytes, at most 368640")],
)
def test_more_points_than_there_is_room_for(
    channel: Callable[[TopicEntry], Channel], count: int, found: str
) -> None:
    """A sample that is larger than any that could be accepted is refused by its size alone."""
    way = channel(topics.TRAJECTORY)
    (received,) = way.through(trajectory_bytes(count))
    with pytest.raises(DecodeError, match=found) as refused:
        decode_trajectory(received, new_points())
    assert refused.value.reason is DecodeReason.LENGTH


@pytest.fixture
def forged(participant: NewParticipant, domain_id: int) -> Iterator[tuple[Forger, Subscription]]:
    """A subscription to steering reports, and a forger that speaks for its writer."""
    entry = topics.STEERING
    subscription = participant().subscription(entry.name, entry.type_name, DEEP)
    with peer("publish", domain_id) as process:
        guid = bytes.fromhex(line(process))
        wait_for(subscription.take_newest)
        forger = Forger(domain_id, guid, next_number=2)
        yield forger, subscription
        forger.close()


def steering(number: int) -> bytes:
    return inputs.encode_steering(inputs.Steering(Time(number, 0), 0.5))


@pytest.mark.live
def test_forged_datagrams_reach_the_subscription(forged: tuple[Forger, Subscription]) -> None:
    """The check of the check: a good payload does arrive this way."""
    forger, subscription = forged
    forger.send(steering(9))
    assert inputs.decode_steering(wait_for(subscription.take_newest).data).stamp.sec == 9


@pytest.mark.live
def test_forged_payloads_of_every_size_below_the_message(
    forged: tuple[Forger, Subscription],
) -> None:
    """Sizes 0 to 3 have no whole header: the network layer must not let them through."""
    forger, subscription = forged
    for size in (0, 1, 2, 3, 4, 5, 6, 8, 12, 15):
        forger.send(steering(1)[:size], counts=size >= 4)
    forger.send(steering(1000))
    forger.send(steering(2)[:12] + b"\xff\xff\xff\xff")
    forger.send(steering(1001))
    received: list[bytes] = []
    while not received or inputs.decode_steering(received[-1]).stamp.sec != 1001:
        received += [one.data for one in wait_for(lambda: subscription.take_all() or None)]
    assert [inputs.decode_steering(one).stamp.sec for one in received] == [1000, 2, 1001]


@pytest.mark.live
@pytest.mark.parametrize("missing", [1, 2, 4])
def test_a_sample_without_one_fragment_is_never_delivered(
    missing: int, participant: NewParticipant, domain_id: int
) -> None:
    """Row 17; the same fragments without a gap are delivered.

    Best effort: a reliable reader would wait for the sample until the real writer denies it.
    """
    entry = topics.STEERING
    qos = replace(DEEP, reliability="best_effort")
    subscription = participant().subscription(entry.name, entry.type_name, qos)
    with peer("publish", domain_id) as process:
        forger = Forger(domain_id, bytes.fromhex(line(process)), next_number=2)
        wait_for(subscription.matched)
        forger.send_fragments(steering(5), 4, without=missing)
        forger.send_fragments(steering(6), 4, without=0)
        forger.close()
        seconds: list[int] = []
        while 6 not in seconds:
            taken = wait_for(lambda: subscription.take_all() or None)
            seconds += [inputs.decode_steering(sample.data).stamp.sec for sample in taken]
    assert 5 not in seconds


@pytest.mark.live
@pytest.mark.parametrize("kind", [0, 1, 2, 3, 6, 7, 9, 11, NO_ENCAPSULATION])
def test_forged_encapsulations(kind: int, forged: tuple[Forger, Subscription]) -> None:
    """Big endian is read, everything else but plain CDR is refused; never anything in between."""
    forger, subscription = forged
    little = steering(77)
    words = [little[i : i + 4] for i in range(4, 16, 4)]
    body = b"".join(word[::-1] for word in words) if kind == 0 else little[4:]
    forger.send(kind.to_bytes(2, "big") + b"\0\0" + body, counts=kind != NO_ENCAPSULATION)
    forger.send(steering(1000))
    seconds: list[int] = []
    while not seconds or seconds[-1] != 1000:
        for sample in wait_for(lambda: subscription.take_all() or None):
            try:
                seconds.append(inputs.decode_steering(sample.data).stamp.sec)
            except DecodeError:
                seconds.append(-1)
    assert [n for n in seconds if n >= 0] == ([77, 1000] if kind in (0, 1) else [1000])
