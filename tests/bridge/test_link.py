# SPDX-License-Identifier: Apache-2.0
"""When a route opens, closes, and what it tells a user."""

from __future__ import annotations

from safety_island.bridge.link import WaitFor
from safety_island.dds import topics
from safety_island.dds.qos import Qos
from safety_island.messages.inputs import STEERING, Steering, encode_steering
from safety_island.messages.wire import Time
from tests.bridge.conftest import Rig

ONE_WAY = f"from_domain: A\nto_domain: B\ntopics:\n  /t: {{type: {STEERING}}}\n"
SAMPLE = encode_steering(Steering(Time(1, 2), 0.5))


def test_waits_for_a_publisher_and_stays(rig: Rig) -> None:
    bridge = rig.bridge(ONE_WAY)
    witness = rig.participant("B")
    rig.settle()
    assert not bridge.all_open
    assert witness.publications("/t") == []
    publisher = rig.participant("A").publisher("/t", STEERING)
    rig.until(lambda: bridge.all_open and witness.publications("/t"))
    publisher.close()
    rig.settle()
    assert bridge.all_open


def test_auto_remove_closes_and_opens_again(rig: Rig) -> None:
    bridge = rig.bridge(ONE_WAY, WaitFor(publisher=True, auto_remove=True))
    for _ in range(2):
        publisher = rig.participant("A").publisher("/t", STEERING)
        rig.until(lambda: bridge.all_open)
        publisher.close()
        rig.until(lambda: not bridge.all_open)
    assert sum("closed" in line for line in rig.said) == 2


def test_waits_for_a_subscription(rig: Rig) -> None:
    wait_for = WaitFor(publisher=True, subscription=True, auto_remove=True)
    bridge = rig.bridge(ONE_WAY, wait_for)
    publisher = rig.participant("A").publisher("/t", STEERING)
    rig.settle()
    assert not bridge.all_open
    subscription = rig.participant("B").subscription("/t", STEERING)
    rig.match(publisher, subscription)
    assert publisher.write(SAMPLE)
    assert rig.receive(subscription) == [SAMPLE]
    subscription.close()
    rig.until(lambda: not bridge.all_open)


def test_waits_for_a_subscription_alone(rig: Rig) -> None:
    bridge = rig.bridge(ONE_WAY, WaitFor(publisher=False, subscription=True))
    rig.settle()
    assert not bridge.all_open
    rig.participant("B").subscription("/t", STEERING)
    rig.until(lambda: bridge.all_open)


def test_waits_for_nobody(rig: Rig) -> None:
    bridge = rig.bridge(ONE_WAY, WaitFor(publisher=False))
    rig.turn()
    assert bridge.all_open


def test_the_entry_sets_the_qos(rig: Rig) -> None:
    qos = "{reliability: reliable, durability: transient_local, lifespan: 5000000000}"
    bridge = rig.bridge(ONE_WAY.replace("}", f", qos: {qos}}}"), WaitFor(publisher=False))
    witness = rig.participant("B")
    rig.until(lambda: bridge.all_open and witness.publications("/t"))
    found = witness.publications("/t")[0].qos
    assert (found.reliability, found.durability) == ("reliable", "transient_local")
    assert (found.lifespan_ns, found.lease_ns) == (5_000_000_000, None)


def test_looks_like_one_node_on_each_domain(rig: Rig) -> None:
    """A neighbour finds the ends of the route on the right side, and nothing else."""
    bridge = rig.bridge(ONE_WAY, WaitFor(publisher=False))
    near, far = rig.participant("A"), rig.participant("B")
    rig.until(lambda: bridge.all_open and near.subscriptions("/t") and far.publications("/t"))
    assert near.publications("/t") == far.subscriptions("/t") == []


def test_a_publisher_that_offers_too_little_is_told_once(rig: Rig) -> None:
    rig.bridge(ONE_WAY.replace("}", ", qos: {reliability: reliable}}"))
    rig.participant("A").publisher("/t", STEERING, Qos(reliability="best_effort"))
    rig.until(lambda: any("does not offer" in line for line in rig.said))
    rig.settle()
    assert sum("does not offer" in line for line in rig.said) == 1


def test_a_publisher_of_another_type_is_told(rig: Rig) -> None:
    bridge = rig.bridge(ONE_WAY)
    rig.participant("A").publisher("/t", topics.CONTROL.type_name)
    rig.until(lambda: any(f"published as {topics.CONTROL.type_name}" in s for s in rig.said))
    assert not bridge.all_open
    assert ".yaml:4" in rig.said[-1]
