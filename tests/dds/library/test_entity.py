# SPDX-License-Identifier: Apache-2.0
"""Entities of the library: made, named and deleted."""

from __future__ import annotations

import pytest

from safety_island.dds import raw_topic
from safety_island.dds.errors import DdsError
from safety_island.dds.library.entity import checked, delete, guid_of, strerror
from safety_island.messages import inputs
from safety_island.messages.wire import Time
from tests.dds.conftest import NewParticipant

TOPIC = "/entity"
DATA = inputs.encode_steering(inputs.Steering(Time(1, 2), 0.5))


def test_delete_is_at_once_and_only_once(participant: NewParticipant) -> None:
    publisher = participant().publisher(TOPIC, inputs.STEERING)
    assert publisher.write(DATA)
    delete(publisher.entity)
    assert raw_topic.write(publisher.entity, DATA) < 0
    with pytest.raises(DdsError, match="has no GUID"):
        guid_of(publisher.entity)
    delete(publisher.entity)


def test_what_cannot_be_disposed_is_told(participant: NewParticipant) -> None:
    publisher = participant().publisher(TOPIC, inputs.STEERING)
    publisher.close()
    assert raw_topic.dispose(publisher.entity) < 0
    publisher.withdraw()
    assert (publisher.failed, bool(publisher.last_error)) == (1, True)


def test_return_codes_in_words() -> None:
    assert strerror(-10) == "timed out (-10)"
    assert strerror(-99) == "failed (-99)"
    assert checked(3, "a wait") == 3
    with pytest.raises(DdsError, match=r"^a wait: out of resources \(-5\)$"):
        checked(-5, "a wait")
