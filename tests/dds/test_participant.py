# SPDX-License-Identifier: Apache-2.0
"""Participants: discovery, presence, waiting, several in one process, deaths of others."""

from __future__ import annotations

import threading
from dataclasses import dataclass

import pytest
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float32, int32, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy
from cyclonedds.qos import Qos as CycloneQos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

from safety_island.dds import presence, topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.endpoints import Subscription
from safety_island.dds.errors import DdsError
from safety_island.dds.library.loading import loaded
from safety_island.dds.participant import Participant
from safety_island.dds.qos import DEFAULT, LATCHED, Qos
from safety_island.dds.raw_topic import OpaqueTopic
from safety_island.errors import ConfigurationError
from safety_island.messages import codec, inputs, registry
from safety_island.messages.wire import Time
from tests.dds.conftest import LOOPBACK, NewParticipant
from tests.dds.peer import line, peer
from tests.dds.waiting import wait_for

STEERING = topics.STEERING
REPORT = inputs.encode_steering(inputs.Steering(Time(1, 2), 0.5))


@dataclass
class _Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class _SteeringReport(IdlStruct, typename="autoware_vehicle_msgs::msg::dds_::SteeringReport_"):
    stamp: _Time
    steering_tire_angle: float32


class _Foreign:
    """A plain cyclonedds program on the same topic, with types written by hand."""

    def __init__(self, domain_id: int) -> None:
        self.participant = DomainParticipant(domain_id)
        self.topic = Topic(self.participant, "rt" + STEERING.name, _SteeringReport)
        self.qos = CycloneQos(Policy.Reliability.Reliable(10_000_000), Policy.History.KeepLast(10))

    def writer(self) -> DataWriter[_SteeringReport]:
        return DataWriter(self.participant, self.topic, self.qos)

    def reader(self) -> DataReader[_SteeringReport]:
        return DataReader(self.participant, self.topic, self.qos)


def test_a_typed_program_of_others_reads_what_we_write(
    participant: NewParticipant, domain_id: int
) -> None:
    publisher = participant().publisher(STEERING.name, STEERING.type_name)
    reader = _Foreign(domain_id).reader()
    wait_for(publisher.matched)
    publisher.write(REPORT)
    (found,) = wait_for(lambda: reader.take(10))
    assert found == _SteeringReport(_Time(1, 2), 0.5)


def test_we_read_what_a_typed_program_of_others_writes(
    participant: NewParticipant, domain_id: int
) -> None:
    subscription = participant().subscription(STEERING.name, STEERING.type_name)
    writer = _Foreign(domain_id).writer()
    wait_for(subscription.matched)
    writer.write(_SteeringReport(_Time(1, 2), 0.5))
    assert wait_for(subscription.take_newest).data == REPORT


def test_remote_endpoints_are_seen_with_type_hash_and_qos(participant: NewParticipant) -> None:
    own, other = participant("one"), participant("two")
    qos = Qos("reliable", "transient_local", 4, deadline_ns=5 * 10**9, lease_ns=10**9)
    publisher = own.publisher(STEERING.name, STEERING.type_name, qos)
    (seen,) = wait_for(lambda: other.publications(STEERING.name))
    assert (seen.guid, seen.participant, seen.topic) == (publisher.guid, own.guid, STEERING.name)
    assert seen.type_name == STEERING.type_name
    assert seen.type_hash == registry.lookup(STEERING.type_name).hash
    assert seen.qos == qos  # what lasts is announced with its depth
    assert own.publications(STEERING.name) == []
    assert other.subscriptions(STEERING.name) == []
    subscription = other.subscription(STEERING.name, STEERING.type_name)
    (asked,) = wait_for(lambda: own.subscriptions(STEERING.name))
    assert asked.guid == subscription.guid
    publisher.close()
    wait_for(lambda: not other.publications(STEERING.name))


def test_the_node_is_announced_with_its_endpoints(participant: NewParticipant) -> None:
    own, other = participant("island"), participant("observer")
    listener = _presence_listener(other)
    publisher = own.publisher(STEERING.name, STEERING.type_name)
    subscription = own.subscription("/x", STEERING.type_name)

    def announced() -> bool:
        for sample in listener.take_all():
            message = codec.decode(presence.TYPE, sample.data)
            (node,) = message["node_entities_info_seq"]
            readers, writers = (
                [bytes(gid["data"]) for gid in node[key]]
                for key in ("reader_gid_seq", "writer_gid_seq")
            )
            if (readers, writers) == ([subscription.guid], [publisher.guid]):
                assert bytes(message["gid"]["data"]) == own.guid
                assert (node["node_namespace"], node["node_name"]) == ("/", "island")
                return True
        return False

    wait_for(announced)


def _presence_listener(own: Participant) -> Subscription:
    topic = own._topic(presence.TOPIC, presence.TYPE)
    qos = LATCHED.with_depth(64)
    return Subscription(own.handle, topic, presence.TYPE, qos, lambda _: None)


def test_another_type_on_our_topic_does_not_match_and_is_told(
    participant: NewParticipant,
) -> None:
    """Row 18 of the fault catalogue."""
    own, other = participant(), participant()
    subscription = own.subscription(STEERING.name, STEERING.type_name)
    wrong = other.publisher(STEERING.name, topics.ODOMETRY.type_name)
    (told,) = wait_for(own.mismatches)
    assert told == (
        f"{STEERING.name}: publisher {wrong.guid.hex()} has type {topics.ODOMETRY.type_name},"
        f" expected {STEERING.type_name}"
    )
    assert (subscription.matched(), wrong.matched()) == (0, 0)


@pytest.mark.parametrize(
    ("offered", "requested", "said"),
    [
        (Qos("best_effort"), DEFAULT, "reliability is best_effort, requested is reliable"),
        (DEFAULT, LATCHED, "durability is volatile, requested is transient_local"),
        (DEFAULT, Qos(deadline_ns=10**9), "deadline_ns is infinite, requested is 1000000000"),
        (
            DEFAULT,
            Qos(liveliness="manual_by_topic"),
            "liveliness is automatic, requested is manual_by_topic",
        ),
        (Qos(lease_ns=2 * 10**9), Qos(lease_ns=10**9), "lease_ns is 2000000000"),
    ],
)
def test_policies_that_exclude_each_other_are_told_on_both_sides(
    offered: Qos, requested: Qos, said: str, participant: NewParticipant
) -> None:
    own, other = participant(), participant()
    publisher = own.publisher(STEERING.name, STEERING.type_name, offered)
    subscription = other.subscription(STEERING.name, STEERING.type_name, requested)
    for side in (own, other):
        (told,) = wait_for(side.mismatches)
        assert said in told
    assert (publisher.matched(), subscription.matched()) == (0, 0)


@pytest.mark.parametrize("qos", [DEFAULT, LATCHED, Qos("best_effort"), Qos(history="keep_all")])
def test_equal_policies_match(qos: Qos, participant: NewParticipant) -> None:
    own, other = participant(), participant()
    publisher = own.publisher(STEERING.name, STEERING.type_name, qos)
    other.subscription(STEERING.name, STEERING.type_name, qos)
    wait_for(publisher.matched)
    wait_for(lambda: other.publications(STEERING.name))
    assert own.mismatches() == other.mismatches() == []


def test_wait_returns_when_there_is_something_to_take(participant: NewParticipant) -> None:
    own, other = participant(), participant()
    subscription = own.subscription(STEERING.name, STEERING.type_name)
    publisher = other.publisher(STEERING.name, STEERING.type_name)
    wait_for(publisher.matched)
    assert not own.wait(0.0)
    thread = threading.Thread(target=publisher.write, args=(REPORT,))
    thread.start()
    assert own.wait(10.0)
    thread.join()
    assert own.wait(0.0)
    assert subscription.take_newest() is not None
    assert not own.wait(0.0)


def test_closing_one_endpoint_leaves_the_others(participant: NewParticipant) -> None:
    own, other = participant(), participant()
    first = own.subscription(STEERING.name, STEERING.type_name)
    second = own.subscription(STEERING.name, STEERING.type_name)
    publisher = other.publisher(STEERING.name, STEERING.type_name)
    wait_for(lambda: publisher.matched() == 2)
    first.close()
    wait_for(lambda: publisher.matched() == 1)
    publisher.write(REPORT)
    assert own.wait(10.0)
    assert second.take_newest() is not None


def test_domains_do_not_mix(domain_pair: tuple[int, int]) -> None:
    one, two = domain_pair
    with (
        Participant(one, LOOPBACK) as a,
        Participant(two, LOOPBACK) as b,
        Participant(one, LOOPBACK) as c,
    ):
        publisher = a.publisher(STEERING.name, STEERING.type_name)
        here = c.subscription(STEERING.name, STEERING.type_name)
        there = b.subscription(STEERING.name, STEERING.type_name)
        wait_for(publisher.matched)
        publisher.write(REPORT)
        assert wait_for(here.take_newest).data == REPORT
        assert there.take_newest() is None
        assert b.publications(STEERING.name) == []


def test_a_domain_can_be_left_and_entered_again(domain_id: int) -> None:
    for _ in range(3):
        own = Participant(domain_id, LOOPBACK)
        own.publisher(STEERING.name, STEERING.type_name)
        own.close()
        own.close()


@pytest.mark.live
def test_a_killed_process_is_noticed_within_its_lease(
    participant: NewParticipant, domain_id: int
) -> None:
    """Rows 12 and 74: kill -9 says no good-bye; only the lease tells."""
    own = participant()
    subscription = own.subscription(STEERING.name, STEERING.type_name)
    with peer("publish", domain_id) as process:
        guid = bytes.fromhex(line(process))
        assert wait_for(subscription.take_newest).writer_guid == guid
        process.kill()
        process.wait()
        wait_for(lambda: not own.publications(STEERING.name))
        wait_for(lambda: not subscription.matched())


def test_an_unknown_type_passes_as_bytes(participant: NewParticipant) -> None:
    own, other = participant(), participant()
    publisher = own.publisher("/a/b", "some_msgs/msg/Thing")
    subscription = other.subscription("/a/b", "some_msgs/msg/Thing", DEFAULT.with_depth(128))
    wait_for(publisher.matched)
    sent = [b"\0\1\0\0" + bytes(range(4 * n)) for n in range(1, 61)] * 2
    assert all(publisher.write(data) for data in sent)
    assert not publisher.write(b"\0\1") and not publisher.write(b"\0\x33\0\0abcd")
    received: list[bytes] = [sample.data for sample in subscription.take_all()]

    def all_there() -> bool:
        received.extend(sample.data for sample in subscription.take_all())
        return len(received) == len(sent)

    wait_for(all_there)
    assert received == sent
    assert other.publications("/a/b")[0].type_hash == ""


def test_an_unknown_type_matches_a_typed_program_of_others(
    domain_id: int, participant: NewParticipant
) -> None:
    """Bytes in, bytes out, between typed peers: what the bridge does with types of others."""
    own = participant()
    own._topics["rt" + STEERING.name, STEERING.type_name] = _opaque(own)
    publisher = own.publisher(STEERING.name, STEERING.type_name)
    subscription = own.subscription(STEERING.name, STEERING.type_name, ignore_own=True)
    foreign = _Foreign(domain_id)
    reader, writer = foreign.reader(), foreign.writer()
    wait_for(lambda: publisher.matched() and subscription.matched())
    publisher.write(REPORT)
    (found,) = wait_for(lambda: reader.take(10))
    assert found == _SteeringReport(_Time(1, 2), 0.5)
    writer.write(_SteeringReport(_Time(1, 2), 0.5))
    assert wait_for(subscription.take_newest).data == REPORT


def _opaque(own: Participant) -> OpaqueTopic:
    return OpaqueTopic(own.handle, "rt" + STEERING.name, STEERING.type_name)


@pytest.mark.parametrize("topic", ["", "a/b", "/a//b", "/a/", "/1a", "/a-b", "/a__b", "/a b", "/"])
def test_an_illegal_topic_name_is_refused(topic: str, participant: NewParticipant) -> None:
    with pytest.raises(ConfigurationError, match="is not legal"):
        participant().publisher(topic, STEERING.type_name)


@pytest.mark.parametrize(("name", "namespace"), [("", "/"), ("a b", "/"), ("a", "b"), ("a", "/1")])
def test_an_illegal_node_name_is_refused(name: str, namespace: str, domain_id: int) -> None:
    with pytest.raises(ConfigurationError, match="is not legal"):
        Participant(domain_id, LOOPBACK, name, namespace)


def test_a_type_name_without_package_is_refused(participant: NewParticipant) -> None:
    with pytest.raises(Exception, match="not of the form package/msg/Name"):
        participant().publisher("/a", "Odometry")


def test_two_types_on_one_topic_do_not_mix(participant: NewParticipant) -> None:
    own, other = participant(), participant()
    publisher = own.publisher("/a", STEERING.type_name)
    own.publisher("/a", topics.ODOMETRY.type_name)
    right = other.subscription("/a", STEERING.type_name)
    wrong = other.subscription("/a", topics.ODOMETRY.type_name)
    wait_for(publisher.matched)
    publisher.write(REPORT)
    assert wait_for(right.take_newest).data == REPORT
    assert wrong.take_newest() is None
    assert (right.matched(), wrong.matched()) == (1, 1)


def test_a_closed_participant_is_told(participant: NewParticipant) -> None:
    own = participant()
    own.close()
    with pytest.raises(DdsError, match=f"topic rt/a of {STEERING.type_name}"):
        own.publisher("/a", STEERING.type_name)


def test_a_participant_that_the_library_refuses_leaves_no_domain_behind(
    domain_id: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(loaded(), "dds_create_participant", lambda *_: -5)
        with pytest.raises(DdsError, match=f"no participant in domain {domain_id}: .*resources"):
            Participant(domain_id, LOOPBACK)
    Participant(domain_id, DdsConfig(loopback_only=True, max_message_size=9000)).close()


def test_the_library_s_refusal_of_a_policy_is_one_line(participant: NewParticipant) -> None:
    with pytest.raises(DdsError, match="was refused") as refused:
        participant().publisher(STEERING.name, STEERING.type_name, Qos(depth=0))
    assert "\n" not in str(refused.value)
