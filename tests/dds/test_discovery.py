# SPDX-License-Identifier: Apache-2.0
"""Discovery: what came and went, in batches, and of which type."""

from __future__ import annotations

from typing import Any

import pytest

from safety_island.dds import binding, discovery, topics
from tests.dds.conftest import NewParticipant
from tests.dds.waiting import wait_for

TOPIC = (topics.STEERING.name, topics.STEERING.type_name)


def test_more_events_than_one_batch_are_all_noted(
    participant: NewParticipant, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They came while nobody looked: a tick must not see the rest of them only in the next one."""
    taken: list[int] = []
    take = binding.take_endpoints

    def counted(reader: int, limit: int) -> list[Any]:
        events = take(reader, limit)
        taken.append(len(events))
        return events

    own, other = participant(), participant()
    count = discovery._BATCH + 44
    for _ in range(count):
        other.publisher(*TOPIC)
    reader = own.subscription(*TOPIC)
    wait_for(lambda: reader.matched() == count, timeout_s=60.0)
    monkeypatch.setattr(binding, "take_endpoints", counted)
    assert len(own.writers(*TOPIC)) == count
    assert taken[0] == discovery._BATCH < sum(taken)


def test_a_publisher_of_another_type_is_none_of_ours(participant: NewParticipant) -> None:
    own, other = participant(), participant()
    right = other.publisher(*TOPIC)
    wrong = other.publisher(TOPIC[0], "std_msgs/msg/String")
    wait_for(lambda: len(own.publications(TOPIC[0])) == 2)
    assert own.writers(*TOPIC) == {right.guid}
    assert own.writers(TOPIC[0], "std_msgs/msg/String") == {wrong.guid}
