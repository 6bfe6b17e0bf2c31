# SPDX-License-Identifier: Apache-2.0
"""A topic that keeps to one publisher: others raise an alarm and do not get through."""

from __future__ import annotations

import threading
from typing import Any

import pytest

from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.qos import LATCHED, Qos
from safety_island.messages.inputs import STEERING, Steering, encode_steering
from safety_island.messages.wire import Time
from tests.bridge.conftest import Rig

DEEP = LATCHED.with_depth(64)


def _text(keys: str) -> str:
    return f"from_domain: A\nto_domain: B\ntopics:\n  /t: {{type: {STEERING}, {keys}}}\n"


FIRST = _text("second_publisher: keep_first")


def _sample(number: int) -> bytes:
    return encode_steering(Steering(Time(number, 0), 0.5))


def _publisher(rig: Rig, qos: Qos = LATCHED) -> Publisher:
    publisher = rig.participant("A").publisher("/t", STEERING, qos)
    rig.settle(30)
    return publisher


def _subscription(rig: Rig, qos: Qos = DEEP) -> Subscription:
    subscription = rig.participant("B").subscription("/t", STEERING, qos)
    rig.until(subscription.matched)
    return subscription


def _taken(rig: Rig, subscription: Subscription) -> list[bytes]:
    rig.settle(30)
    return [sample.data for sample in subscription.take_all()]


def _alarms(rig: Rig) -> list[str]:
    return [line for line in rig.said if "ALARM" in line]


@pytest.mark.parametrize("qos", [LATCHED, Qos(), Qos(reliability="best_effort")], ids=str)
def test_a_second_publisher_is_an_alarm_and_not_forwarded(rig: Rig, qos: Qos) -> None:
    bridge = rig.bridge(FIRST)
    first = _publisher(rig)
    subscription = _subscription(rig)
    second = _publisher(rig, qos)
    for number in range(5):
        assert first.write(_sample(number))
        assert second.write(_sample(100 + number))
        rig.settle(3)
    assert _taken(rig, subscription) == [_sample(number) for number in range(5)]
    rig.until(lambda: _alarms(rig))
    assert second.guid.hex() in _alarms(rig)[0]
    assert f"{first.guid.hex()} /neighbour is forwarded" in _alarms(rig)[0]
    assert bridge.totals()["foreign"] == (5 if qos == LATCHED else 0)


def test_the_alarm_is_an_event_as_well_and_so_is_its_end(rig: Rig) -> None:
    bridge = rig.bridge(FIRST)
    first = _publisher(rig)
    second = _publisher(rig)
    events: list[tuple[str, Any]] = []

    def alarms() -> list[Any]:
        bridge.run(threading.Event(), lambda *event: events.append(event), 0.1)
        return [values for kind, values in events if kind == "alarm"]

    rig.until(alarms)
    name = f"{second.guid.hex()} /neighbour"
    assert (alarms()[0]["topic"], alarms()[0]["others"]) == ("/t", [name])
    assert alarms()[0]["kept"] == [f"{first.guid.hex()} /neighbour"]
    second.close()
    rig.until(lambda: alarms()[-1]["others"] == [])
    assert len(alarms()) == 2


def test_the_next_one_takes_over_with_what_it_has_latched(rig: Rig) -> None:
    rig.bridge(FIRST)
    first, second = _publisher(rig), _publisher(rig)
    subscription = _subscription(rig)
    assert first.write(_sample(1))
    assert second.write(_sample(2))
    assert _taken(rig, subscription) == [_sample(1)]
    first.close()
    assert rig.receive(subscription) == [_sample(2)]
    assert second.write(_sample(3))
    assert rig.receive(subscription) == [_sample(3)]


def test_where_the_file_says_so_a_second_publisher_is_silence(rig: Rig) -> None:
    rig.bridge(_text("second_publisher: silent"))
    first, subscription = _publisher(rig), _subscription(rig)
    assert first.write(_sample(1))
    assert rig.receive(subscription) == [_sample(1)]
    second = _publisher(rig)
    rig.until(lambda: not subscription.matched())
    assert first.write(_sample(2))
    assert second.write(_sample(3))
    assert _taken(rig, subscription) == []
    assert "nothing is forwarded" in _alarms(rig)[0]
    second.close()
    assert rig.receive(subscription) == [_sample(2)]


def test_a_flood_pushes_nothing_out_and_gets_nowhere(rig: Rig) -> None:
    bridge = rig.bridge(FIRST)
    first, second = _publisher(rig, Qos(depth=64)), _publisher(rig, Qos(depth=64))
    subscription = _subscription(rig, Qos(depth=64))
    for number in range(10):
        assert first.write(_sample(number))
        for _ in range(300):
            assert second.write(_sample(1000))
    assert _taken(rig, subscription) == [_sample(number) for number in range(10)]
    rig.until(lambda: bridge.totals()["foreign"] == 3000)
    assert bridge.totals()["superseded"] == 0


def test_without_a_wish_a_flood_pushes_nothing_out_either(rig: Rig) -> None:
    """Every publisher has room of its own while the bridge is busy."""
    rig.bridge(_text("bidirectional: false"))
    first, second = _publisher(rig, Qos(depth=500)), _publisher(rig, Qos(depth=500))
    subscription = _subscription(rig, Qos(depth=5000))
    for number in range(5):
        assert first.write(_sample(number))
        for _ in range(300):
            assert second.write(_sample(1000))
    taken = [data for data in _taken(rig, subscription) if data != _sample(1000)]
    assert taken == [_sample(number) for number in range(5)]


@pytest.mark.parametrize("by", ["GUID", "name"])
def test_the_file_may_name_the_publisher(rig: Rig, by: str) -> None:
    meant = rig.participant("A", "meant").publisher("/t", STEERING, LATCHED)
    other = _publisher(rig)
    name = "/meant" if by == "name" else meant.guid.hex()
    rig.bridge(_text(f"publisher: {name}"))
    subscription = _subscription(rig)
    assert other.write(_sample(1))
    assert meant.write(_sample(2))
    assert _taken(rig, subscription) == [_sample(2)]
    rig.until(lambda: _alarms(rig))
    meant.close()
    assert other.write(_sample(3))
    assert _taken(rig, subscription) == []
