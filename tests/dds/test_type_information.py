"""Matching with peers that announce type information, as recent rmw_cyclonedds does."""

from __future__ import annotations

import pytest

from safety_island.dds.qos import DEFAULT, Qos
from safety_island.dds.raw_topic import OpaqueTopic
from safety_island.messages import registry
from tests.dds.conftest import NewParticipant
from tests.dds.dynamic_types import topic_of
from tests.dds.peer import line, module
from tests.dds.waiting import wait_for

pytestmark = pytest.mark.live
BEST_EFFORT = Qos("best_effort")
MATCHED = "2 2"
"""The peer's own reader and writer, and ours."""


@pytest.mark.parametrize("opaque", [False, True], ids=["typed", "unknown type"])
def test_every_type_matches_in_both_directions(
    opaque: bool, participant: NewParticipant, domain_id: int
) -> None:
    own = participant()
    ends = []
    for name in registry.names():
        topic = topic_of(name)
        if opaque:
            made = OpaqueTopic(own._participant, f"rt{topic}", name)
            own._topics[f"rt{topic}", name] = made
        publisher = own.publisher(topic, name, DEFAULT)
        ends.append((publisher, own.subscription(topic, name, BEST_EFFORT, ignore_own=True)))
    with module("tests.dds.dynamic_types", str(domain_id), *registry.names()) as peer:
        missing = set(registry.names())
        while missing:
            name, _, counts = line(peer).partition(" ")
            if counts == MATCHED:
                missing.discard(name)
        for publisher, subscription in ends:
            wait_for(publisher.matched)
            wait_for(subscription.matched)
