"""One wait over two domains."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from safety_island.dds.config import DdsConfig
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.participant import Participant
from safety_island.dds.wait_group import WaitGroup
from safety_island.messages.inputs import STEERING, Steering, encode_steering
from safety_island.messages.wire import Time
from tests.dds.waiting import wait_for

LOOPBACK = DdsConfig(loopback_only=True)
SAMPLE = encode_steering(Steering(Time(1, 2), 0.1))
Ends = tuple[Publisher, Subscription]


@pytest.fixture
def ends(domain_pair: tuple[int, int]) -> Iterator[list[Ends]]:
    """On each of two domains a publisher and a subscription that have found each other."""
    with ExitStack() as stack:
        found = []
        for domain in domain_pair:
            here, there = (stack.enter_context(Participant(domain, LOOPBACK)) for _ in range(2))
            publisher = there.publisher("/test/steering", STEERING)
            found.append((publisher, here.subscription("/test/steering", STEERING)))
        wait_for(lambda: all(p.matched() and s.matched() for p, s in found))
        yield found


def test_wakes_for_either_domain(ends: list[Ends]) -> None:
    with WaitGroup() as group:
        for _, subscription in ends:
            group.add(subscription)
        assert not group.wait(0.0)
        for publisher, subscription in (*ends, *ends):
            assert publisher.write(SAMPLE)
            assert group.wait(5.0)
            assert [sample.data for sample in subscription.take_all()] == [SAMPLE]
            assert not group.wait(0.0)


def test_what_was_removed_does_not_wake(ends: list[Ends]) -> None:
    (first, heard), (second, removed) = ends
    with WaitGroup() as group:
        group.add(heard)
        group.add(removed)
        group.remove(removed)
        assert second.write(SAMPLE)
        wait_for(lambda: removed.take_newest() is not None)
        assert not group.wait(0.0)
        removed.close()
        assert first.write(SAMPLE)
        assert group.wait(5.0)


def test_closing_twice_is_nothing(ends: list[Ends]) -> None:
    group = WaitGroup()
    group.add(ends[0][1])
    group.close()
    group.close()
