# SPDX-License-Identifier: Apache-2.0
"""What ends on one side of the bridge has ended beyond it."""

from __future__ import annotations

import time

import pytest

from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.library.functions import PROTOTYPES
from safety_island.dds.library.loading import loaded
from safety_island.dds.qos import LATCHED, Qos
from safety_island.messages.inputs import STEERING, Steering, encode_steering
from safety_island.messages.wire import Time
from tests.bridge.conftest import Rig

UNKNOWN = "nowhere_msgs/msg/Unknown"
DEEP = Qos(depth=64)
MANUAL = Qos(durability="transient_local", liveliness="manual_by_topic", lease_ns=300_000_000)


def _text(type_name: str = STEERING, more: str = "") -> str:
    return f"from_domain: A\nto_domain: B\ntopics:\n  /t: {{type: {type_name}{more}}}\n"


def _sample(number: int) -> bytes:
    return encode_steering(Steering(Time(number, 0), 0.5))


def _publisher(rig: Rig, qos: Qos = LATCHED, type_name: str = STEERING) -> Publisher:
    publisher = rig.participant("A").publisher("/t", type_name, qos)
    rig.until(publisher.matched)
    return publisher


def _late(rig: Rig, qos: Qos = LATCHED, type_name: str = STEERING) -> list[bytes]:
    """What a reader receives that comes now."""
    subscription = rig.participant("B").subscription("/t", type_name, qos.with_depth(64))
    rig.settle(40)
    found = [sample.data for sample in subscription.take_all()]
    subscription.close()
    return found


def _subscription(rig: Rig, qos: Qos = LATCHED, type_name: str = STEERING) -> Subscription:
    subscription = rig.participant("B").subscription("/t", type_name, qos.with_depth(64))
    rig.until(subscription.matched)
    return subscription


@pytest.mark.parametrize("type_name", [STEERING, UNKNOWN])
def test_what_was_disposed_no_late_reader_receives(rig: Rig, type_name: str) -> None:
    rig.bridge(_text(type_name))
    publisher = _publisher(rig, type_name=type_name)
    early = _subscription(rig, type_name=type_name)
    assert publisher.write(_sample(1))
    assert rig.receive(early) == [_sample(1)]
    assert _late(rig, type_name=type_name) == [_sample(1)]
    publisher.withdraw()
    rig.settle(20)
    assert _late(rig, type_name=type_name) == []
    assert [raw.is_disposed for raw in early.take_raw()] == [True]
    assert publisher.write(_sample(2))
    assert rig.receive(early) == [_sample(2)]
    assert _late(rig, type_name=type_name) == [_sample(2)]


def test_what_was_disposed_before_the_bridge_took_it_does_not_last(rig: Rig) -> None:
    rig.bridge(_text())
    publisher = _publisher(rig)
    assert publisher.write(_sample(1))
    publisher.withdraw()
    rig.settle(20)
    assert _late(rig) == []


def test_a_publisher_that_leaves_is_gone_beyond(rig: Rig) -> None:
    bridge = rig.bridge(_text())
    publisher = _publisher(rig)
    subscription = _subscription(rig)
    assert publisher.write(_sample(1))
    assert rig.receive(subscription) == [_sample(1)]
    publisher.close()
    rig.until(lambda: not subscription.matched())
    assert bridge.all_open
    assert _late(rig) == []
    again = _publisher(rig)
    rig.until(subscription.matched)
    assert again.write(_sample(2))
    assert rig.receive(subscription) == [_sample(2)]


def test_what_it_sent_last_arrives_before_it_is_gone(rig: Rig) -> None:
    rig.bridge(_text())
    for number in range(5):
        publisher, subscription = _publisher(rig, DEEP), _subscription(rig, DEEP)
        assert publisher.write(_sample(number))
        publisher.close()
        assert rig.receive(subscription) == [_sample(number)]
        rig.until(lambda: not subscription.matched())  # noqa: B023
        subscription.close()


def test_of_two_publishers_each_has_its_own_end(rig: Rig) -> None:
    rig.bridge(_text())
    first = _publisher(rig)
    assert first.write(_sample(1))
    subscription = _subscription(rig)
    assert rig.receive(subscription) == [_sample(1)]
    writer = rig.participant("B")
    rig.until(lambda: writer.publications("/t"))
    shown = writer.publications("/t")[0].guid
    second = _publisher(rig)
    rig.settle(20)
    first.close()
    rig.until(lambda: shown not in {other.guid for other in writer.publications("/t")})
    assert _late(rig) == []
    assert second.write(_sample(2))
    assert rig.receive(subscription) == [_sample(2)]


def test_what_two_publishers_have_latched_lasts_until_each_is_gone(rig: Rig) -> None:
    """As with /tf_static: one does not push out what the other one said."""
    rig.bridge(_text())
    publishers = [_publisher(rig), _publisher(rig)]
    for number, publisher in enumerate(publishers):
        assert publisher.write(_sample(number))
    rig.settle(20)
    assert sorted(_late(rig)) == [_sample(0), _sample(1)]
    publishers[0].close()
    rig.settle(20)
    assert _late(rig) == [_sample(1)]


def test_a_publisher_that_unregisters_is_gone_until_it_sends_again(rig: Rig) -> None:
    rig.bridge(_text())
    publisher, subscription = _publisher(rig), _subscription(rig)
    assert publisher.write(_sample(1))
    assert rig.receive(subscription) == [_sample(1)]
    unregister = PROTOTYPES["dds_dispose"].bind(loaded().handle, "dds_unregister_instance")
    assert unregister(publisher.entity, bytes(1)) == 0
    rig.until(lambda: not subscription.matched())
    assert _late(rig) == []
    assert publisher.write(_sample(2))
    assert rig.receive(subscription) == [_sample(2)]


def test_a_publisher_that_lost_its_liveliness_is_gone_until_it_sends_again(rig: Rig) -> None:
    rig.bridge(_text())
    publisher, subscription = _publisher(rig, MANUAL), _subscription(rig)
    for number in range(2):
        assert publisher.write(_sample(number))
        assert rig.receive(subscription) == [_sample(number)]
        rig.until(lambda: not subscription.matched())
        assert _late(rig) == []


@pytest.mark.parametrize("depth", [1, 3])
def test_what_is_latched_keeps_the_depth_that_was_offered(rig: Rig, depth: int) -> None:
    rig.bridge(_text())
    publisher, early = _publisher(rig, LATCHED.with_depth(depth)), _subscription(rig)
    for number in range(5):
        assert publisher.write(_sample(number))
        assert rig.receive(early) == [_sample(number)]
    assert _late(rig) == [_sample(number) for number in range(5 - depth, 5)]


def test_the_entry_sets_the_depth_of_what_is_latched(rig: Rig) -> None:
    rig.bridge(_text(more=", qos: {depth: 2}"))
    publisher, early = _publisher(rig, LATCHED.with_depth(5)), _subscription(rig)
    for number in range(5):
        assert publisher.write(_sample(number))
        assert rig.receive(early) == [_sample(number)]
    assert _late(rig) == [_sample(3), _sample(4)]


def test_of_a_long_history_that_comes_at_once_the_newest_is_forwarded(rig: Rig) -> None:
    """A publisher may keep more than what is in force; the entry says how much that is."""
    publisher = rig.participant("A").publisher("/t", STEERING, LATCHED.with_depth(10))
    for number in range(10):
        assert publisher.write(_sample(number))
    subscription = rig.participant("B").subscription("/t", STEERING, LATCHED.with_depth(64))
    bridge = rig.bridge(_text(more=", qos: {depth: 1}"))
    assert rig.receive(subscription) == [_sample(9)]
    rig.settle()
    assert subscription.take_all() == []
    assert bridge.totals()["superseded"] == 9


@pytest.mark.parametrize("end", ["disposes", "leaves"])
def test_what_ended_while_the_bridge_stood_still_is_not_passed_on(rig: Rig, end: str) -> None:
    """A command from before a silence would arrive after it."""
    bridge = rig.bridge(_text())
    publisher, subscription = _publisher(rig), _subscription(rig)
    assert publisher.write(_sample(1))
    assert rig.receive(subscription) == [_sample(1)]
    assert publisher.write(_sample(2))
    if end == "disposes":
        publisher.withdraw()
    else:
        publisher.close()
    time.sleep(0.5)
    bridge.forward(0.0)
    rig.settle()
    assert subscription.take_all() == []
    assert _late(rig) == []
