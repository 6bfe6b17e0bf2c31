"""The QoS of a route from its entry and from the publishers that are there."""

from __future__ import annotations

from typing import Any

import pytest

from safety_island.bridge.config_file import AUTO, QosWish
from safety_island.bridge.matching import match, unheard
from safety_island.dds.qos import Qos

RELIABLE = Qos()
BEST_EFFORT = Qos(reliability="best_effort")
LATCHED = Qos(durability="transient_local")


@pytest.mark.parametrize(
    ("offers", "reliability", "durability", "warnings"),
    [
        ([], "reliable", "volatile", 0),
        ([RELIABLE], "reliable", "volatile", 0),
        ([RELIABLE, RELIABLE], "reliable", "volatile", 0),
        ([BEST_EFFORT], "best_effort", "volatile", 0),
        ([RELIABLE, BEST_EFFORT], "best_effort", "volatile", 1),
        ([LATCHED], "reliable", "transient_local", 0),
        ([LATCHED, RELIABLE], "reliable", "volatile", 1),
        ([LATCHED, BEST_EFFORT], "best_effort", "volatile", 2),
    ],
)
def test_takes_what_hears_every_publisher(
    offers: list[Qos], reliability: str, durability: str, warnings: int
) -> None:
    found = match(QosWish(), offers)
    assert (found.qos.reliability, found.qos.durability) == (reliability, durability)
    assert len(found.warnings) == warnings
    assert unheard(found.qos, offers) == []


def test_the_entry_wins_and_is_told_when_it_cannot_be_met() -> None:
    wish = QosWish(reliability="reliable", durability="transient_local")
    found = match(wish, [RELIABLE, BEST_EFFORT])
    assert (found.qos.reliability, found.qos.durability) == ("reliable", "transient_local")
    told = {warning.split("'")[1] for warning in found.warnings}
    assert told == {"reliable", "transient_local"}


def test_history_and_depth_are_the_entrys() -> None:
    assert match(QosWish(), [Qos(depth=1)]).qos.depth == 10
    found = match(QosWish(history="keep_all", depth=3), []).qos
    assert (found.history, found.depth) == ("keep_all", 3)


@pytest.mark.parametrize("policy", ["deadline", "lifespan"])
@pytest.mark.parametrize(
    ("wish", "offers", "expected"),
    [
        (None, [5, 7], None),
        (3, [5, 7], 3),
        (AUTO, [5, 7], 7),
        (AUTO, [5, None], None),
        (AUTO, [], None),
    ],
)
def test_durations(policy: str, wish: Any, offers: list[int | None], expected: int | None) -> None:
    publishers = [Qos(**{f"{policy}_ns": offer}) for offer in offers]  # type: ignore[arg-type]
    found = match(QosWish(**{policy: wish}), publishers).qos
    assert getattr(found, f"{policy}_ns") == expected


def test_liveliness_is_automatic_unless_asked_for() -> None:
    manual = Qos(liveliness="manual_by_topic", lease_ns=10)
    found = match(QosWish(), [manual]).qos
    assert (found.liveliness, found.lease_ns) == ("automatic", None)
    wished = match(QosWish(liveliness="manual_by_topic", lease=20), [manual])
    assert (wished.qos.liveliness, wished.qos.lease_ns) == ("manual_by_topic", 20)
    assert wished.warnings == ()


@pytest.mark.parametrize(
    ("wanted", "offer", "policies"),
    [
        (Qos(deadline_ns=5), Qos(deadline_ns=5), []),
        (Qos(deadline_ns=5), Qos(deadline_ns=6), ["deadline"]),
        (Qos(deadline_ns=5), Qos(), ["deadline"]),
        (Qos(), Qos(deadline_ns=5), []),
        (Qos(lease_ns=5), Qos(lease_ns=6), ["liveliness_lease_duration"]),
        (Qos(liveliness="manual_by_topic"), Qos(), ["liveliness 'manual_by_topic'"]),
        (Qos(lifespan_ns=1), Qos(lifespan_ns=2), []),
    ],
)
def test_what_is_not_heard(wanted: Qos, offer: Qos, policies: list[str]) -> None:
    assert unheard(wanted, [offer, offer]) == policies
