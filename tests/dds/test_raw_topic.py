# SPDX-License-Identifier: Apache-2.0
"""Serialized samples through the public C functions: checked by type, or passed as they are."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from safety_island.dds import raw_topic
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.errors import DdsError
from safety_island.dds.library.entity import RETCODE_BAD_PARAMETER
from safety_island.dds.qos import DEFAULT
from safety_island.dds.raw_topic import OpaqueTopic, Room, filled
from safety_island.messages import codec, inputs, registry
from safety_island.messages.wire import Time
from tests.dds.conftest import NewParticipant
from tests.dds.waiting import wait_for
from tests.messages.oracle import rosbags_bytes
from tests.messages.strategies import messages

Ends = tuple[Publisher, Publisher, Subscription]
TOPIC = "/raw"
DATA = inputs.encode_steering(inputs.Steering(Time(1, 2), 0.5))


@pytest.fixture
def pair(participant: NewParticipant) -> tuple[Publisher, Subscription]:
    own = participant()
    return (
        own.publisher(TOPIC, inputs.STEERING),
        own.subscription(TOPIC, inputs.STEERING),
    )


def test_a_sample_comes_with_its_writer_and_its_time(pair: tuple[Publisher, Subscription]) -> None:
    publisher, subscription = pair
    assert raw_topic.take(subscription.entity, 10, Room()) == []
    assert raw_topic.write(publisher.entity, DATA) == 0
    (sample,) = raw_topic.take(subscription.entity, 10, Room())
    assert type(sample.data) is bytes and sample.data == DATA
    assert sample.valid is True and sample.is_alive
    assert sample.source_timestamp_ns > 1e18
    assert subscription._find(sample.publication_handle) == publisher.guid


def test_more_samples_than_a_batch_come_in_order(participant: NewParticipant) -> None:
    own = participant()
    publisher = own.publisher(TOPIC, inputs.STEERING)
    subscription = own.subscription(TOPIC, inputs.STEERING, DEFAULT.with_depth(256))
    sent = [inputs.encode_steering(inputs.Steering(Time(n, 0), 0.5)) for n in range(200)]
    assert all(publisher.write(data) for data in sent)
    room = Room()
    limited = raw_topic.take(subscription.entity, 70, room)
    rest = raw_topic.take(subscription.entity, 999, room)
    assert [sample.data for sample in limited + rest] == sent
    assert len(limited) == 70


def test_data_are_filled_up_to_a_multiple_of_four() -> None:
    assert [len(filled(bytes(n))) for n in range(4, 10)] == [4, 8, 8, 8, 8, 12]


def test_a_dead_entity_is_an_error() -> None:
    assert raw_topic.write(1, DATA) < 0
    with pytest.raises(DdsError, match=r"taking samples failed: "):
        raw_topic.take(1, 1, Room())


@pytest.mark.parametrize("size", range(4))
def test_data_shorter_than_a_header_never_reach_the_library(
    size: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(raw_topic, "loaded", None)
    assert raw_topic.write(1, bytes(size)) == RETCODE_BAD_PARAMETER


@pytest.mark.parametrize("name", registry.names())
@settings(
    max_examples=20,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_the_library_checks_every_type_and_swaps_it(
    name: str, data: st.DataObject, ends: Callable[[str], Ends]
) -> None:
    """What an independent serializer made passes in either byte order; cut short it does not."""
    checked, unchecked, subscription = ends(name)
    message = data.draw(messages(name))
    little, big = (rosbags_bytes(name, message, little_endian=order) for order in (True, False))
    cut = little[: (len(little) - 1) & ~3]
    assert not checked.write(cut)
    assert checked.write(little) and checked.write(big)
    assert _received(subscription, 2) == [filled(little)] * 2
    assert unchecked.write(cut) and unchecked.write(little)
    assert _received(subscription, 1) == [filled(little)]


def test_a_string_longer_than_its_bound_is_refused(ends: Callable[[str], Ends]) -> None:
    name = "rmw_dds_common/msg/NodeEntitiesInfo"
    checked, unchecked, subscription = ends(name)
    message = {**codec.default(name), "node_namespace": "n" * 256, "node_name": "n" * 256}
    good = rosbags_bytes(name, message)
    bad = rosbags_bytes(name, {**message, "node_name": "n" * 257})
    assert not checked.write(bad)
    assert unchecked.write(bad) and unchecked.write(good)
    assert _received(subscription, 1) == [filled(good)]


@pytest.fixture
def ends(participant: NewParticipant) -> Callable[[str], Ends]:
    """Make one set of endpoints for each type."""
    made: dict[str, Ends] = {}

    def of(name: str) -> Ends:
        if name not in made:
            made[name] = _ends(participant, name)
        return made[name]

    return of


def _ends(participant: NewParticipant, name: str) -> Ends:
    """Return a writer whose library checks, one that checks nothing, and a subscription."""
    topic, other = f"/raw/{name.split('/')[2]}", participant("attacker")
    other._topics[f"rt{topic}", name] = OpaqueTopic(other.handle, f"rt{topic}", name)
    publishers = participant().publisher(topic, name), other.publisher(topic, name)
    subscription = participant().subscription(topic, name, DEFAULT.with_depth(256))
    wait_for(lambda: subscription.matched() == 2)
    for publisher in publishers:
        wait_for(publisher.matched)
    return *publishers, subscription


def _received(subscription: Subscription, count: int) -> list[bytes]:
    found: list[bytes] = []

    def enough() -> bool:
        found.extend(sample.data for sample in subscription.take_all())
        return len(found) >= count

    wait_for(enough)
    return found
