# SPDX-License-Identifier: Apache-2.0
"""The bridge on loopback: samples pass as they are, once, in both directions."""

from __future__ import annotations

from pathlib import Path

import pytest

from safety_island.dds import topics
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.qos import LATCHED, Qos
from safety_island.dds.topics import BRIDGED
from safety_island.messages import codec
from safety_island.messages.inputs import STEERING, Steering, encode_steering
from safety_island.messages.wire import Time
from tests.bridge.conftest import Rig

SHIPPED = Path(__file__).parents[2] / "demo" / "bridge" / "bridge-config.yaml"
DEEP = Qos(depth=64)
ONE_WAY = f"from_domain: A\nto_domain: B\ntopics:\n  /t: {{type: {STEERING}}}\n"
BOTH_WAYS = ONE_WAY.replace("}", ", bidirectional: true}")


def _steering(number: int) -> bytes:
    return encode_steering(Steering(Time(number, 0), 0.5))


def _publisher(rig: Rig, letter: str, qos: Qos = DEEP) -> Publisher:
    return rig.participant(letter).publisher("/t", STEERING, qos)


def _subscription(rig: Rig, letter: str, qos: Qos = DEEP) -> Subscription:
    return rig.participant(letter).subscription("/t", STEERING, qos)


def _send(publisher: Publisher, count: int) -> list[bytes]:
    samples = [_steering(number) for number in range(count)]
    assert all(publisher.write(sample) for sample in samples)
    return samples


def test_the_six_topics_in_both_directions(rig: Rig) -> None:
    """With the shipped file: bytes arrive unchanged, on the side where they belong."""
    text = SHIPPED.read_text().replace("domain: 1", "domain: A").replace("domain: 2", "domain: B")
    bridge = rig.bridge(text)
    main, island = rig.participant("A"), rig.participant("B")
    for topic in BRIDGED:
        inward = topic in topics.INPUTS
        sender, receiver = (main, island) if inward else (island, main)
        publisher = sender.publisher(topic.name, topic.type_name, topic.qos)
        subscription = receiver.subscription(topic.name, topic.type_name, topic.subscription_qos)
        rig.until(lambda: publisher.matched() and subscription.matched())  # noqa: B023
        message = codec.encode(topic.type_name, {})
        message += bytes(-len(message) % 4)  # as RTPS pads it
        assert publisher.write(message)
        assert rig.receive(subscription) == [message]
    assert bridge.all_open
    assert bridge.totals()["forwarded"] == 6


def test_order_is_kept(rig: Rig) -> None:
    rig.bridge(ONE_WAY.replace("}", ", qos: {depth: 64}}"))
    publisher, subscription = _publisher(rig, "A"), _subscription(rig, "B")
    rig.match(publisher, subscription)
    sent = _send(publisher, 50)
    assert rig.receive(subscription, 50) == sent


def test_remap(rig: Rig) -> None:
    rig.bridge(ONE_WAY.replace("}", ", remap: ~/u}"))
    publisher = _publisher(rig, "A")
    subscription = rig.participant("B").subscription("/domain_bridge/u", STEERING, DEEP)
    rig.match(publisher, subscription)
    assert _send(publisher, 3) == rig.receive(subscription, 3)


@pytest.mark.parametrize(("here", "there"), ["AB", "BA"])
def test_its_own_output_is_not_fed_back(rig: Rig, here: str, there: str) -> None:
    bridge = rig.bridge(BOTH_WAYS)
    publisher, subscription = _publisher(rig, here), _subscription(rig, there)
    backward = _publisher(rig, there)  # so that the other direction is open, too
    listener = _subscription(rig, here)
    rig.match(publisher, subscription, backward, listener)
    assert _send(publisher, 5) == rig.receive(subscription, 5)
    rig.settle()
    assert subscription.take_all() == []
    assert len(listener.take_all()) == 5
    assert bridge.totals()["forwarded"] == 5


@pytest.mark.parametrize("back", ["from_domain: B, to_domain: A", "reversed: true"])
def test_two_entries_in_opposite_directions_are_one_that_goes_both_ways(
    rig: Rig, back: str
) -> None:
    """As in ROS 2: a bridge does not hear what it published itself."""
    rig.bridge(f"{ONE_WAY}  /t: {{type: {STEERING}, {back}}}\n")
    publishers = [_publisher(rig, letter) for letter in "AB"]
    subscriptions = [_subscription(rig, letter) for letter in "AB"]
    rig.match(*publishers, *subscriptions)
    sent = [_send(publisher, 3) for publisher in publishers]
    rig.settle()
    assert [len(one.take_all()) for one in subscriptions] == [6, 6]
    assert all(sent)


def test_what_one_entry_published_no_other_one_forwards(rig: Rig) -> None:
    """The reference's example has both: chatter to two domains, and back from one of them."""
    text = f"{ONE_WAY}  /t: {{type: {STEERING}, to_domain: C}}\n"
    text += f"  /t: {{type: {STEERING}, reversed: true}}\n"
    rig.bridge(text + f"  /t: {{type: {STEERING}, remap: /u}}\n")
    publishers = [_publisher(rig, letter) for letter in "AB"]
    subscriptions = [_subscription(rig, letter) for letter in "ABC"]
    other = rig.participant("B").subscription("/u", STEERING, DEEP)
    rig.match(*publishers, *subscriptions, other)
    for publisher, expected in zip(publishers, ([3, 3, 3, 3], [3, 3, 0, 0]), strict=True):
        _send(publisher, 3)
        rig.settle()
        assert [len(one.take_all()) for one in (*subscriptions, other)] == expected


def test_a_late_joiner_gets_the_last_transient_local_sample(rig: Rig) -> None:
    publisher = _publisher(rig, "A", LATCHED)
    assert publisher.write(_steering(1))
    bridge = rig.bridge(ONE_WAY)
    rig.until(lambda: bridge.totals()["forwarded"] == 1)
    late = _subscription(rig, "B", LATCHED)
    assert rig.receive(late) == [_steering(1)]


def test_the_publisher_restarts(rig: Rig) -> None:
    rig.bridge(ONE_WAY)
    subscription = _subscription(rig, "B")
    for _ in range(3):
        publisher = _publisher(rig, "A")
        rig.match(publisher, subscription)
        assert _send(publisher, 3) == rig.receive(subscription, 3)
        publisher.close()


def test_the_publisher_restarts_with_other_qos(rig: Rig) -> None:
    """Beyond the bridge there is what the publisher that is there now offers."""
    rig.bridge(ONE_WAY)
    witness = rig.participant("B")
    offers = [DEEP, Qos(reliability="best_effort", depth=64), LATCHED.with_depth(64)]

    def shown() -> list[tuple[str, str]]:
        found = [other.qos for other in witness.publications("/t")]
        return [(qos.reliability, qos.durability) for qos in found]

    for qos in offers:
        publisher = _publisher(rig, "A", qos)
        rig.until(lambda: shown() == [(qos.reliability, qos.durability)])  # noqa: B023
        subscription = _subscription(rig, "B", qos)
        rig.match(publisher, subscription)
        assert _send(publisher, 1) == rig.receive(subscription)
        publisher.close()
        subscription.close()


def test_the_subscriber_restarts(rig: Rig) -> None:
    rig.bridge(ONE_WAY)
    publisher = _publisher(rig, "A")
    for _ in range(2):
        subscription = _subscription(rig, "B")
        rig.match(publisher, subscription)
        assert _send(publisher, 3) == rig.receive(subscription, 3)
        subscription.close()


def test_the_bridge_restarts(rig: Rig) -> None:
    publisher, subscription = _publisher(rig, "A"), _subscription(rig, "B")
    for _ in range(2):
        bridge = rig.bridge(ONE_WAY)
        rig.match(publisher, subscription)
        assert _send(publisher, 3) == rig.receive(subscription, 3)
        rig.stop(bridge)
        rig.until(lambda: not publisher.matched() and not subscription.matched())
