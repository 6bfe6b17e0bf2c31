# SPDX-License-Identifier: Apache-2.0
"""A publisher that joins, leaves, or sends nothing disturbs nobody who was heard."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.library.layouts import PUBLICATIONS
from safety_island.dds.qos import LATCHED, Qos
from safety_island.messages.inputs import STEERING, Steering, encode_steering
from safety_island.messages.wire import Time
from tests.bridge.conftest import Rig

ONE_WAY = f"from_domain: A\nto_domain: B\ntopics:\n  /t: {{type: {STEERING}}}\n"
RELIABLE = Qos(depth=64)
BEST_EFFORT = Qos(reliability="best_effort", depth=64)
LASTING = LATCHED.with_depth(64)
WEAKEST = Qos(reliability="best_effort", durability="volatile", depth=64)
KINDS = [RELIABLE, BEST_EFFORT, LASTING, Qos("best_effort", "transient_local", 64)]


def _sample(number: int) -> bytes:
    return encode_steering(Steering(Time(number, 0), 0.5))


def _publisher(rig: Rig, qos: Qos) -> Publisher:
    publisher = rig.participant("A").publisher("/t", STEERING, qos)
    rig.until(publisher.matched)
    return publisher


def _subscription(rig: Rig, qos: Qos) -> Subscription:
    subscription = rig.participant("B").subscription("/t", STEERING, qos)
    rig.until(subscription.matched)
    return subscription


def _send(rig: Rig, publisher: Publisher, numbers: range) -> list[bytes]:
    samples = [_sample(number) for number in numbers]
    for sample in samples:
        assert publisher.write(sample)
        rig.turn()
    return samples


def _taken(rig: Rig, subscription: Subscription) -> list[bytes]:
    rig.settle(20)
    return [sample.data for sample in subscription.take_all()]


@pytest.mark.parametrize("newcomer", KINDS, ids=str)
@pytest.mark.parametrize("first", [RELIABLE, LASTING], ids=str)
def test_who_says_nothing_changes_nothing(rig: Rig, first: Qos, newcomer: Qos) -> None:
    rig.bridge(ONE_WAY)
    publisher, witness = _publisher(rig, first), rig.participant("B")
    subscription = _subscription(rig, first)
    before = witness.publications("/t")
    sent = _send(rig, publisher, range(5))
    other = _publisher(rig, newcomer)
    sent += _send(rig, publisher, range(5, 10))
    assert witness.publications("/t") == before
    other.close()
    sent += _send(rig, publisher, range(10, 15))
    assert _taken(rig, subscription) == sent
    assert witness.publications("/t") == before


@pytest.mark.parametrize("newcomer", KINDS, ids=str)
@pytest.mark.parametrize("first", KINDS, ids=str)
def test_who_joins_is_heard_as_well_and_nothing_is_lost_or_doubled(
    rig: Rig, first: Qos, newcomer: Qos
) -> None:
    rig.bridge(ONE_WAY)
    publisher = _publisher(rig, first)
    subscription = _subscription(rig, WEAKEST)
    sent = _send(rig, publisher, range(5))
    other = _publisher(rig, newcomer)
    more = []
    for number in range(5, 15):
        sent += _send(rig, publisher, range(number, number + 1))
        more += _send(rig, other, range(100 + number, 101 + number))
    taken = _taken(rig, subscription)
    assert [one for one in taken if one in sent] == sent
    assert [one for one in taken if one in more] == more
    assert len(taken) == len(sent) + len(more)


def test_a_reliable_reader_beyond_hears_a_newcomer_of_best_effort(rig: Rig) -> None:
    """What the bridge itself sends may be more reliable than what it received."""
    rig.bridge(ONE_WAY)
    first, subscription = _publisher(rig, RELIABLE), _subscription(rig, RELIABLE)
    assert _send(rig, first, range(1)) == _taken(rig, subscription)
    assert _send(rig, _publisher(rig, BEST_EFFORT), range(1, 4)) == _taken(rig, subscription)


@pytest.mark.parametrize("newcomer", [RELIABLE, LASTING], ids=str)
def test_a_stronger_newcomer_serves_readers_that_nobody_served(rig: Rig, newcomer: Qos) -> None:
    rig.bridge(ONE_WAY)
    publisher, weak = _publisher(rig, BEST_EFFORT), _subscription(rig, WEAKEST)
    strict = rig.participant("B").subscription("/t", STEERING, newcomer)
    sent = _send(rig, publisher, range(3))
    more = _send(rig, _publisher(rig, newcomer), range(3, 6))
    assert _taken(rig, strict) == more
    assert _taken(rig, weak) == sent + more
    assert any("asks for more than the publishers in domain" in line for line in rig.said)


def test_what_was_not_latched_is_never_latched_beyond(rig: Rig) -> None:
    """A late reader would take an old sample for the state that is in force."""
    rig.bridge(ONE_WAY)
    lasting, passing = _publisher(rig, LATCHED), _publisher(rig, RELIABLE)
    early = _subscription(rig, WEAKEST)
    sent = _send(rig, lasting, range(1)) + _send(rig, passing, range(1, 4))
    assert _taken(rig, early) == sent
    late = _subscription(rig, LASTING)
    assert _taken(rig, late) == sent[:1]


def test_those_who_are_there_at_the_start_differ(rig: Rig) -> None:
    publishers = [rig.participant("A").publisher("/t", STEERING, qos) for qos in KINDS]
    rig.bridge(ONE_WAY)
    readers = [rig.participant("B").subscription("/t", STEERING, qos) for qos in KINDS]
    rig.until(lambda: all(end.matched() for end in publishers))
    sent = [_send(rig, one, range(n, n + 3)) for n, one in enumerate(publishers)]
    rig.until(lambda: all(end.matched() for end in readers))
    assert len(_taken(rig, readers[1])) == sum(map(len, sent))
    assert _taken(rig, readers[2]) == sent[2]


@pytest.mark.parametrize("qos", [RELIABLE, LATCHED], ids=str)
def test_a_publisher_that_was_away_is_forwarded_again(rig: Rig, qos: Qos) -> None:
    """The lease lapsed and was renewed between two looks, as after a stall of the bridge."""
    bridge = rig.bridge(ONE_WAY)
    publisher, subscription = _publisher(rig, qos), _subscription(rig, WEAKEST)
    assert _send(rig, publisher, range(3)) == _taken(rig, subscription)
    source = bridge.links[0]._source
    (known,) = source.publications("/t")
    assert publisher.write(_sample(3))
    time.sleep(0.05)  # it has come, and was not taken yet
    source._found[PUBLICATIONS]._known[known.guid] = replace(known, number=known.number + 9)
    bridge.links[0].look()
    assert _taken(rig, subscription) == [_sample(3)]
    assert _send(rig, publisher, range(4, 7)) == _taken(rig, subscription)
    assert bridge.totals()["failed"] == 0


def test_a_publisher_that_only_just_lives_is_forwarded(rig: Rig) -> None:
    """It left before anybody looked who it was."""
    bridge = rig.bridge(ONE_WAY)
    _publisher(rig, RELIABLE)
    subscription = _subscription(rig, RELIABLE)
    for number in range(3):
        brief = rig.participant("A").publisher("/t", STEERING, RELIABLE)
        while not brief.matched():
            bridge.forward(0.001)
        assert brief.write(_sample(number))
        brief.close()
        assert _taken(rig, subscription) == [_sample(number)]


def test_readers_that_wait_beyond_lose_nothing_when_a_route_opens(rig: Rig) -> None:
    rig.bridge(ONE_WAY)
    subscription = rig.participant("B").subscription("/t", STEERING, RELIABLE)
    rig.settle(20)
    for _ in range(3):
        publisher = rig.participant("A").publisher("/t", STEERING, RELIABLE)
        rig.until(publisher.matched)
        assert _send(rig, publisher, range(5)) == rig.receive(subscription, 5)
        publisher.close()
        rig.until(lambda: not subscription.matched())


def test_the_delay_lets_others_be_found_before_the_route_opens(rig: Rig) -> None:
    bridge = rig.bridge(ONE_WAY.replace("}", ", delay: 300}"))
    rig.participant("A").publisher("/t", STEERING, RELIABLE)
    began = time.monotonic()
    rig.until(lambda: bridge.all_open)
    assert time.monotonic() - began >= 0.3
