# SPDX-License-Identifier: Apache-2.0
"""What discovery found, read through the library's own structures."""

from __future__ import annotations

import ctypes as ct

import pytest

from safety_island.dds import raw_topic
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.errors import DdsError
from safety_island.dds.library import builtin
from safety_island.dds.library.builtin import BuiltinReader, matched_writer
from safety_island.dds.library.entity import delete, guid_of, handle_of
from safety_island.dds.library.layouts import HANDLE, PUBLICATIONS, Guid
from safety_island.dds.participant import Participant
from safety_island.dds.qos import LATCHED
from safety_island.dds.raw_topic import Room
from safety_island.messages import inputs
from safety_island.messages.wire import Time
from tests.dds.conftest import LOOPBACK, NewParticipant
from tests.dds.waiting import wait_for

TOPIC = "/builtin"
DATA = inputs.encode_steering(inputs.Steering(Time(1, 2), 0.5))


@pytest.fixture
def pair(participant: NewParticipant) -> tuple[Publisher, Subscription]:
    own = participant()
    return (
        own.publisher(TOPIC, inputs.STEERING),
        own.subscription(TOPIC, inputs.STEERING),
    )


def test_an_endpoint_with_all_that_is_known_of_it(participant: NewParticipant) -> None:
    own, other = participant(), participant()
    reader = BuiltinReader(own.handle, PUBLICATIONS)
    reader.take()
    publisher = other.publisher(TOPIC, inputs.STEERING, LATCHED.with_depth(3))
    (event,) = wait_for(reader.take)
    assert (event.guid, event.participant) == (publisher.guid, other.guid)
    assert (event.topic, event.type_name) == (
        "rt/builtin",
        "autoware_vehicle_msgs::msg::dds_::SteeringReport_",
    )
    assert event.qos == LATCHED.with_depth(3)
    assert event.user_data.startswith(b"typehash=RIHS01_")
    assert event.alive and event.handle == handle_of(publisher.entity)
    publisher.close()
    gone = wait_for(reader.take)[-1]
    assert (gone.guid, gone.alive) == (publisher.guid, False)


def test_reading_discovery_on_a_dead_entity_is_an_error(participant: NewParticipant) -> None:
    reader = BuiltinReader(participant().handle, PUBLICATIONS)
    delete(reader.entity)
    with pytest.raises(DdsError, match=r"reading discovery failed: "):
        reader.take()


def test_a_writer_is_found_by_its_handle(pair: tuple[Publisher, Subscription]) -> None:
    publisher, subscription = pair
    raw_topic.write(publisher.entity, DATA)
    (sample,) = raw_topic.take(subscription.entity, 10, Room())
    assert matched_writer(subscription.entity, sample.publication_handle) == publisher.guid
    assert sample.publication_handle == handle_of(publisher.entity)
    assert matched_writer(subscription.entity, 12345) is None


def test_structures_of_another_shape_are_refused_in_one_line(
    domain_id: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A release that puts a number in front of the participant's GUID."""

    class Shifted(ct.Structure):
        _fields_ = (
            ("key", Guid),
            ("inserted", ct.c_uint64),
            ("participant_key", Guid),
            ("participant_instance_handle", HANDLE),
        )

    with monkeypatch.context() as patch:
        patch.setattr(builtin, "EndpointData", Shifted)
        with pytest.raises(DdsError, match=r"libddsc.* are not known; expected one of .* 0\.10"):
            Participant(domain_id, LOOPBACK)
    with Participant(domain_id, LOOPBACK) as own:
        assert guid_of(own.handle) == own.guid
