# SPDX-License-Identifier: Apache-2.0
"""What is used of the private C layer, nailed down: a new release that differs fails here."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import pytest
from cyclonedds import _clayer
from cyclonedds.core import Entity

from safety_island.dds import binding, raw_topic
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.errors import DdsError
from safety_island.dds.qos import DEFAULT
from safety_island.dds.raw_topic import Room
from safety_island.messages import inputs
from safety_island.messages.wire import Time
from tests.dds.conftest import NewParticipant
from tests.dds.waiting import wait_for

TOPIC = "/binding"
DATA = inputs.encode_steering(inputs.Steering(Time(1, 2), 0.5))


@pytest.fixture
def pair(participant: NewParticipant) -> tuple[Publisher, Subscription]:
    own = participant()
    return (
        own.publisher(TOPIC, inputs.STEERING),
        own.subscription(TOPIC, inputs.STEERING),
    )


def test_the_installed_release_is_the_pinned_one() -> None:
    assert version("cyclonedds") == binding.PINNED_VERSION == "11.0.1"


def test_another_release_is_refused_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(binding, "version", lambda _: "99.0")
    with pytest.raises(DdsError, match=r"found cyclonedds 99\.0, expected exactly 11\.0\.1"):
        binding.check_version()


def test_the_functions_exist() -> None:
    for name in ("take_endpoint", "get_matched_publication_data"):
        assert callable(getattr(_clayer, f"ddspy_{name}"))


def test_reading_discovery_on_a_dead_entity_is_an_error() -> None:
    with pytest.raises(DdsError, match="reading discovery failed"):
        binding.take_endpoints(1, 1)


def test_a_writer_is_found_by_its_handle(pair: tuple[Publisher, Subscription]) -> None:
    publisher, subscription = pair
    raw_topic.write(publisher._ref, DATA)
    (sample,) = raw_topic.take(subscription._ref, 10, Room())
    found = binding.matched_writer(subscription._ref, sample.publication_handle)
    assert found == publisher.guid
    assert binding.matched_writer(subscription._ref, 12345) is None


def test_a_peer_s_policies_that_cannot_be_read_do_not_stop_discovery(
    participant: NewParticipant, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(_: int) -> None:
        raise KeyError

    monkeypatch.setattr(binding, "_convert_qos", fails)
    own, other = participant(), participant()
    publisher = other.publisher(TOPIC, inputs.STEERING)
    (seen,) = wait_for(lambda: own.publications(TOPIC))
    assert (seen.guid, seen.type_name, seen.type_hash) == (publisher.guid, inputs.STEERING, "")
    assert seen.qos == DEFAULT


def test_what_cannot_be_disposed_is_told(pair: tuple[Publisher, Subscription]) -> None:
    publisher, _ = pair
    publisher.close()
    assert raw_topic.dispose(publisher._ref) < 0
    publisher.withdraw()
    assert (publisher.failed, bool(publisher.last_error)) == (1, True)


def test_delete_is_at_once_and_only_once(participant: NewParticipant) -> None:
    own = participant()
    publisher = own.publisher(TOPIC, inputs.STEERING)
    entity: Any = publisher._writer
    binding.delete(entity)
    assert entity._ref not in Entity._entities
    assert raw_topic.write(publisher._ref, DATA) < 0
    binding.delete(entity)
