# SPDX-License-Identifier: Apache-2.0
"""Topics in memory."""

from __future__ import annotations

import pytest

from safety_island.dds.qos import DEFAULT, LATCHED, Qos
from safety_island.errors import ConfigurationError
from safety_island.messages.errors import UnknownTypeError
from safety_island.node.memory import MemoryDomain
from safety_island.platform.sim.clock import SimClock

TOPIC = ("/a/b", "nav_msgs/msg/Odometry")


@pytest.fixture
def domain() -> MemoryDomain:
    return MemoryDomain(SimClock(5))


def test_the_newest_message_is_taken_once(domain: MemoryDomain) -> None:
    reader, writer = domain.subscription(*TOPIC, DEFAULT), domain.publisher(*TOPIC, DEFAULT)
    assert reader.take_newest() is None
    writer.write(b"old")
    assert writer.write(b"new")
    sample = reader.take_newest()
    assert sample is not None
    assert (sample.data, sample.source_timestamp_ns, sample.writer_guid) == (b"new", 5, writer.guid)
    assert reader.take_newest() is None
    assert (reader.received, reader.superseded, reader.invalid) == (2, 1, 0)


def test_every_subscription_receives(domain: MemoryDomain) -> None:
    readers = [domain.subscription(*TOPIC, DEFAULT) for _ in range(2)]
    domain.publisher(*TOPIC, DEFAULT).write(b"x")
    assert [reader.take_newest() is not None for reader in readers] == [True, True]


@pytest.mark.parametrize(
    ("writer_qos", "reader_qos", "arrives"),
    [(LATCHED, LATCHED, True), (LATCHED, DEFAULT, False), (DEFAULT, LATCHED, False)],
)
def test_a_late_joiner_gets_what_is_latched(
    domain: MemoryDomain, writer_qos: Qos, reader_qos: Qos, arrives: bool
) -> None:
    domain.publisher(*TOPIC, writer_qos).write(b"state")
    assert (domain.subscription(*TOPIC, reader_qos).take_newest() is not None) == arrives


def test_a_late_joiner_does_not_get_what_was_withdrawn(domain: MemoryDomain) -> None:
    writer = domain.publisher(*TOPIC, LATCHED)
    writer.write(b"x")
    writer.withdraw()
    assert domain.subscription(*TOPIC, LATCHED).take_newest() is None


def test_writers_have_different_identities(domain: MemoryDomain) -> None:
    assert domain.publisher(*TOPIC, DEFAULT).guid != domain.publisher(*TOPIC, DEFAULT).guid


def test_one_topic_has_one_type(domain: MemoryDomain) -> None:
    domain.publisher(*TOPIC, DEFAULT)
    with pytest.raises(ConfigurationError, match=r"'/a/b' has the type nav_msgs/msg/Odometry"):
        domain.subscription("/a/b", "autoware_control_msgs/msg/Control", DEFAULT)


def test_names_are_those_of_ros(domain: MemoryDomain) -> None:
    with pytest.raises(ConfigurationError, match="not legal"):
        domain.publisher("a b", TOPIC[1], DEFAULT)
    with pytest.raises(UnknownTypeError):
        domain.publisher("/a", "nav_msgs/msg/Odometri", DEFAULT)


def test_what_others_say_is_kept_out(domain: MemoryDomain) -> None:
    reader = domain.subscription(*TOPIC, DEFAULT)
    own, other = domain.publisher(*TOPIC, DEFAULT), domain.publisher(*TOPIC, DEFAULT)
    assert reader.keep_to(own.guid)
    for _ in range(100):
        other.write(b"other")
    own.write(b"own")
    assert [sample.data for sample in reader.take_all()] == [b"own"]
    assert (reader.received, reader.kept_out) == (1, 100)
    assert reader.keep_to(b"")
    other.write(b"other")
    assert [sample.data for sample in reader.take_all()] == [b"other"]


def test_what_living_publishers_keep_is_received_again(domain: MemoryDomain) -> None:
    reader = domain.subscription(*TOPIC, LATCHED)
    gone, kept = domain.publisher(*TOPIC, LATCHED), domain.publisher(*TOPIC, LATCHED)
    gone.write(b"gone")
    kept.write(b"kept")
    domain.publisher(*TOPIC, LATCHED)
    reader.take_all()
    gone.close()
    reader.renew()
    assert [sample.data for sample in reader.take_all()] == [b"kept"]


def test_a_volatile_subscription_has_nothing_to_receive_again(domain: MemoryDomain) -> None:
    reader = domain.subscription(*TOPIC, DEFAULT)
    domain.publisher(*TOPIC, LATCHED).write(b"x")
    reader.take_all()
    reader.renew()
    assert reader.take_all() == ()
