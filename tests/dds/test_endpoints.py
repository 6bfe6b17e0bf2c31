# SPDX-License-Identifier: Apache-2.0
"""Publisher and subscription on loopback: every topic of the table, newest first, counters."""

from __future__ import annotations

import ctypes as ct
import signal
import time

import pytest

from safety_island.dds import topics
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.library.functions import PROTOTYPES
from safety_island.dds.library.layouts import ANY, SampleInfo
from safety_island.dds.library.loading import loaded
from safety_island.dds.participant import Participant
from safety_island.dds.qos import DEFAULT, LATCHED, Qos
from safety_island.dds.sample import Sample
from safety_island.dds.topics import TopicEntry
from safety_island.messages import codec, inputs
from safety_island.messages.wire import Time
from tests.dds.conftest import NewParticipant
from tests.dds.peer import line, peer
from tests.dds.waiting import wait_for
from tests.messages.samples import hot_messages

STEERING = topics.STEERING
DEEP = DEFAULT.with_depth(64)
BYTES = {hot.name: hot.data for hot in hot_messages(300)}


def report(number: int) -> bytes:
    return inputs.encode_steering(inputs.Steering(Time(number, 0), 0.25))


def connected(
    own: Participant, other: Participant, qos: Qos = DEFAULT, reader_qos: Qos = DEEP
) -> tuple[Publisher, Subscription]:
    publisher = own.publisher(STEERING.name, STEERING.type_name, qos)
    subscription = other.subscription(STEERING.name, STEERING.type_name, reader_qos)
    wait_for(publisher.matched)
    wait_for(subscription.matched)
    return publisher, subscription


def newest(subscription: Subscription) -> Sample:
    return wait_for(subscription.take_newest)


@pytest.mark.parametrize("entry", topics.TOPICS, ids=lambda entry: entry.key)
def test_every_topic_of_the_table_carries_its_message(
    entry: TopicEntry, participant: NewParticipant
) -> None:
    publisher = participant("one").publisher(entry.name, entry.type_name, entry.qos)
    subscription = participant("two").subscription(
        entry.name, entry.type_name, entry.subscription_qos
    )
    wait_for(publisher.matched)
    data = BYTES[entry.type_name]
    assert publisher.write(data)
    sample = newest(subscription)
    assert sample.data == data + bytes(-len(data) % 4)
    assert codec.encode(entry.type_name, codec.decode(entry.type_name, sample.data)) == data
    assert sample.writer_guid == publisher.guid
    assert abs(sample.source_timestamp_ns - time.time_ns()) < 60 * 10**9


def test_the_newest_is_taken_and_the_rest_is_counted(participant: NewParticipant) -> None:
    publisher, subscription = connected(participant(), participant())
    assert subscription.take_newest() is None
    for number in range(5):
        assert publisher.write(report(number))
    wait_for(lambda: _unread(subscription) == 5)
    sample = newest(subscription)
    assert inputs.decode_steering(sample.data).stamp.sec == 4
    assert (subscription.received, subscription.superseded) == (5, 4)
    assert (publisher.sent, publisher.failed) == (5, 0)
    assert subscription.take_newest() is None


def test_all_samples_come_in_order(participant: NewParticipant) -> None:
    publisher, subscription = connected(participant(), participant())
    for number in range(20):
        publisher.write(report(number))
    wait_for(lambda: _unread(subscription) == 20)
    seconds = [inputs.decode_steering(s.data).stamp.sec for s in subscription.take_all()]
    assert seconds == list(range(20))
    assert (subscription.received, subscription.superseded) == (20, 0)


def test_a_backlog_beyond_the_depth_leaves_the_newest(participant: NewParticipant) -> None:
    publisher, subscription = connected(participant(), participant(), reader_qos=DEFAULT)
    for number in range(10):
        publisher.write(report(number))
    sample = newest(subscription)
    assert inputs.decode_steering(sample.data).stamp.sec == 9
    assert subscription.superseded == 0


def test_a_closing_writer_leaves_no_data(participant: NewParticipant) -> None:
    publisher, subscription = connected(participant(), participant())
    publisher.write(report(1))
    newest(subscription)
    publisher.close()
    wait_for(lambda: subscription.take_newest() or subscription.invalid)
    assert subscription.received == 1
    assert subscription.matched() == 0


def test_what_was_sent_before_the_writer_left_is_kept(participant: NewParticipant) -> None:
    """Autodispose is off: a closing writer must not take its last state away."""
    publisher, subscription = connected(participant(), participant())
    publisher.write(report(7))
    publisher.close()
    wait_for(lambda: not subscription.matched())
    sample = newest(subscription)
    assert inputs.decode_steering(sample.data).stamp.sec == 7


def test_a_late_joiner_receives_the_last_state(participant: NewParticipant) -> None:
    publisher = participant().publisher(STEERING.name, STEERING.type_name, LATCHED)
    publisher.write(report(1))
    publisher.write(report(2))
    late = participant().subscription(STEERING.name, STEERING.type_name, LATCHED.with_depth(8))
    assert inputs.decode_steering(newest(late).data).stamp.sec == 2
    assert late.received == 1


def test_a_late_joiner_receives_nothing_that_was_withdrawn(participant: NewParticipant) -> None:
    publisher = participant().publisher(STEERING.name, STEERING.type_name, LATCHED)
    present = participant().subscription(STEERING.name, STEERING.type_name, LATCHED)
    publisher.write(report(1))
    newest(present)
    publisher.withdraw()
    late = participant().subscription(STEERING.name, STEERING.type_name, LATCHED)
    wait_for(lambda: not late.take_all() and late.invalid)
    assert late.received == 0
    publisher.write(report(2))
    for subscription in (present, late):
        assert inputs.decode_steering(newest(subscription).data).stamp.sec == 2


def test_more_than_one_last_state_when_the_depth_says_so(participant: NewParticipant) -> None:
    qos = LATCHED.with_depth(3)
    publisher = participant().publisher(STEERING.name, STEERING.type_name, qos)
    for number in range(5):
        publisher.write(report(number))
    late = participant().subscription(STEERING.name, STEERING.type_name, LATCHED.with_depth(8))
    wait_for(lambda: _unread(late) == 3)
    assert [inputs.decode_steering(s.data).stamp.sec for s in late.take_all()] == [2, 3, 4]


def test_what_is_no_message_is_refused_and_counted(participant: NewParticipant) -> None:
    publisher, subscription = connected(participant(), participant())
    for data in (b"", b"\0\1", b"\0\1\0\0", report(1)[:-4]):
        assert not publisher.write(data)
    assert (publisher.sent, publisher.failed) == (0, 4)
    assert "not CDR of this type" in publisher.last_error
    assert publisher.write(report(1))
    newest(subscription)


def test_a_subscription_may_be_deaf_to_its_own_participant(participant: NewParticipant) -> None:
    own, other = participant(), participant()
    publisher = own.publisher(STEERING.name, STEERING.type_name)
    deaf = own.subscription(STEERING.name, STEERING.type_name, ignore_own=True)
    hearing = other.subscription(STEERING.name, STEERING.type_name)
    wait_for(publisher.matched)
    publisher.write(report(1))
    newest(hearing)
    assert deaf.take_newest() is None


@pytest.mark.live
def test_a_message_returns_from_another_process(
    participant: NewParticipant, domain_id: int
) -> None:
    own = participant()
    publisher = own.publisher(STEERING.name, STEERING.type_name)
    back = own.subscription("/back", STEERING.type_name)
    with peer("echo", domain_id) as process:
        assert line(process) == "ready"
        wait_for(publisher.matched)
        wait_for(back.matched)
        publisher.write(report(5))
        sample = newest(back)
        assert sample.data == report(5)
        assert sample.writer_guid == own.publications("/back")[0].guid


@pytest.mark.live
def test_a_reader_that_stands_still_cannot_block_a_writer_for_long(
    participant: NewParticipant, domain_id: int
) -> None:
    """Reliable, keep all: the writer waits for room, but never beyond its bound."""
    publisher = participant().publisher(
        topics.TRAJECTORY.name, topics.TRAJECTORY.type_name, Qos(history="keep_all")
    )
    with peer("hold", domain_id) as process:
        assert line(process) == "ready"
        wait_for(publisher.matched)
        process.send_signal(signal.SIGSTOP)
        while publisher.write(BYTES[topics.TRAJECTORY.type_name]):
            assert publisher.sent < 2000
        process.send_signal(signal.SIGCONT)
    assert publisher.failed == 1
    assert "timed out" in publisher.last_error


def _unread(subscription: Subscription) -> int:
    """How many samples wait in the reader; reads them without taking them."""
    most = 1024
    found, infos = (ct.c_void_p * most)(), (SampleInfo * most)()
    read = PROTOTYPES["dds_takecdr"].bind(loaded().handle, "dds_readcdr")
    count: int = read(subscription.entity, found, most, infos, ANY)
    for data in found[:count]:
        loaded().ddsi_serdata_unref(data)
    return count
