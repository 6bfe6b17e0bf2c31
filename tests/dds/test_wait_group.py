# SPDX-License-Identifier: Apache-2.0
"""One wait over two domains."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from safety_island.dds.config import DdsConfig
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.errors import DdsError
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
    with WaitGroup[str]() as group:
        assert group.wait(0.0) == []
        for name, (_, subscription) in zip("ab", ends, strict=True):
            group.add(subscription, name)
        assert group.wait(0.0) == []
        for name, (publisher, subscription) in zip("abab", (*ends, *ends), strict=True):
            assert publisher.write(SAMPLE)
            assert group.wait(5.0) == [name]
            assert [sample.data for sample in subscription.take_all()] == [SAMPLE]
            assert group.wait(0.0) == []


def test_says_for_which_it_wakes(ends: list[Ends]) -> None:
    with WaitGroup[str]() as group:
        for name, (publisher, subscription) in zip("ab", ends, strict=True):
            group.add(subscription, name)
            assert publisher.write(SAMPLE)
        wait_for(lambda: len(group.wait(1.0)) == 2)
        assert sorted(group.wait(1.0)) == ["a", "b"]
        ends[0][1].take_all()
        assert group.wait(1.0) == ["b"]


def test_what_was_removed_does_not_wake(ends: list[Ends]) -> None:
    (first, heard), (second, removed) = ends
    with WaitGroup[str]() as group:
        group.add(heard, "heard")
        group.add(removed, "removed")
        group.remove(removed)
        assert second.write(SAMPLE)
        wait_for(lambda: removed.take_newest() is not None)
        assert group.wait(0.0) == []
        removed.close()
        assert first.write(SAMPLE)
        assert group.wait(5.0) == ["heard"]


def test_refuses_what_is_closed(ends: list[Ends]) -> None:
    subscription = ends[0][1]
    subscription.close()
    with WaitGroup[None]() as group, pytest.raises(DdsError, match="cannot be waited for"):
        group.add(subscription, None)


def test_closing_twice_is_nothing(ends: list[Ends]) -> None:
    group = WaitGroup[None]()
    group.add(ends[0][1], None)
    group.close()
    group.close()
    with pytest.raises(DdsError, match="waiting for samples failed"):
        group.wait(0.0)
