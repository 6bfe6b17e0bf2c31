# SPDX-License-Identifier: Apache-2.0
"""One end of a talk: ``python -m tests.dds.talk ROLE DOMAIN LIBRARY``.

``answer`` sends back all that it receives on the topics of the table; ``ask`` sends one message on
each and prints what it found, one line each. The library is a path of libddsc or its folder.
"""

from __future__ import annotations

import sys
from pathlib import Path

from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.library.loading import loaded
from safety_island.dds.participant import Participant
from safety_island.dds.raw_topic import filled
from safety_island.dds.sample import Sample
from tests.dds.waiting import wait_for
from tests.messages.samples import hot_messages

BYTES = {hot.name: hot.data for hot in hot_messages(300)}
LIMIT_S = 30.0


def answer(own: Participant) -> None:
    """Send each message back on a topic of its own, until standard input closes."""
    ends = [
        (
            own.subscription(entry.name, entry.type_name, entry.subscription_qos),
            own.publisher(f"/back{entry.name}", entry.type_name, entry.qos),
        )
        for entry in topics.TOPICS
    ]
    print("ready", flush=True)
    while True:
        own.wait(1.0)
        for subscription, back in ends:
            for sample in subscription.take_all():
                back.write(sample.data)


def ask(own: Participant) -> None:
    """Send on every topic, compare what returns, and watch one publisher go."""
    for entry in topics.TOPICS:
        returned = _exchange(own, entry)
        (source,) = own.publications(f"/back{entry.name}")
        node = wait_for(lambda source=source: own.node_of(source), LIMIT_S)  # type: ignore[misc]
        hashed = "hash" if source.type_hash.startswith("RIHS01_") else "no hash"
        same = "same" if returned else "changed"
        print(entry.key, same, node, hashed, source.qos == entry.qos, flush=True)
    print("mismatches", own.mismatches(), flush=True)


def _exchange(own: Participant, entry: topics.TopicEntry) -> bool:
    """Return whether what was sent came back as it was, from the publisher that was found."""
    publisher = own.publisher(entry.name, entry.type_name, entry.qos)
    back = own.subscription(f"/back{entry.name}", entry.type_name, entry.subscription_qos)
    wait_for(lambda: publisher.matched() and back.matched(), LIMIT_S)
    data = BYTES[entry.type_name]
    refused = not publisher.write(data[:-8]) and "not CDR of this type" in publisher.last_error

    def again() -> Sample | None:
        """Send until it returns: the other end may not have found this one's endpoints yet."""
        publisher.write(data)
        own.wait(0.1)
        return back.take_newest()

    sample = wait_for(again, LIMIT_S)
    (source,) = own.publications(f"/back{entry.name}")
    same = sample.data == filled(data) and sample.writer_guid == source.guid
    return refused and same


if __name__ == "__main__":
    config = DdsConfig(loopback_only=True, library=Path(sys.argv[3]))
    with Participant(int(sys.argv[2]), config, sys.argv[1]) as participant:
        print(loaded().release, flush=True)
        {"answer": answer, "ask": ask}[sys.argv[1]](participant)
