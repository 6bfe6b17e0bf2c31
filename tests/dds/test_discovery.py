# SPDX-License-Identifier: Apache-2.0
"""Discovery: what came and went, in batches, and of which type."""

from __future__ import annotations

import pytest

from safety_island.dds import topics
from safety_island.dds.library.builtin import BATCH, BuiltinReader, RawEndpoint
from tests.dds.conftest import NewParticipant
from tests.dds.waiting import wait_for

TOPIC = (topics.STEERING.name, topics.STEERING.type_name)


def test_more_events_than_one_batch_are_all_noted(
    participant: NewParticipant, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They came while nobody looked: a tick must not see the rest of them only in the next one."""
    taken: list[int] = []
    take = BuiltinReader.take

    def counted(reader: BuiltinReader) -> list[RawEndpoint]:
        events = take(reader)
        taken.append(len(events))
        return events

    own, other = participant(), participant()
    count = BATCH + 44
    for _ in range(count):
        other.publisher(*TOPIC)
    reader = own.subscription(*TOPIC)
    wait_for(lambda: reader.matched() == count, timeout_s=60.0)
    monkeypatch.setattr(BuiltinReader, "take", counted)
    assert len(own.writers(*TOPIC)) == count
    assert taken[0] == BATCH < sum(taken)


def test_a_publisher_of_another_type_is_none_of_ours(participant: NewParticipant) -> None:
    own, other = participant(), participant()
    right = other.publisher(*TOPIC)
    wrong = other.publisher(TOPIC[0], "std_msgs/msg/String")
    wait_for(lambda: len(own.publications(TOPIC[0])) == 2)
    assert own.writers(*TOPIC) == {right.guid}
    assert own.writers(TOPIC[0], "std_msgs/msg/String") == {wrong.guid}
