# SPDX-License-Identifier: Apache-2.0
"""The QoS of both ends of a route from its entry and from the publishers that are there."""

from __future__ import annotations

from typing import Any

import pytest

from safety_island.bridge.config_file import AUTO, QosWish
from safety_island.bridge.matching import offer_beyond, request, room, unmet
from safety_island.dds.qos import Qos

RELIABLE = Qos()
BEST_EFFORT = Qos(reliability="best_effort")
LATCHED = Qos(durability="transient_local")


@pytest.mark.parametrize("offer", [RELIABLE, BEST_EFFORT, LATCHED])
def test_listens_with_all_that_a_publisher_offers(offer: Qos) -> None:
    asked = request(QosWish(), offer)
    assert (asked.reliability, asked.durability) == (offer.reliability, offer.durability)
    assert asked.history == "keep_all"
    assert unmet(QosWish(), offer) == []


def test_the_entry_wins_and_what_a_publisher_lacks_is_named() -> None:
    wish = QosWish(reliability="reliable", durability="transient_local")
    assert unmet(wish, LATCHED) == []
    assert unmet(wish, BEST_EFFORT) == [
        "reliability is best_effort, requested is reliable",
        "durability is volatile, requested is transient_local",
    ]


@pytest.mark.parametrize(
    ("offers", "reliability", "durability"),
    [
        ([], "reliable", "volatile"),
        ([RELIABLE], "reliable", "volatile"),
        ([BEST_EFFORT], "best_effort", "volatile"),
        ([BEST_EFFORT, RELIABLE], "reliable", "volatile"),
        ([LATCHED], "reliable", "transient_local"),
        ([Qos("best_effort", "transient_local")], "best_effort", "transient_local"),
    ],
)
def test_offers_beyond_what_is_offered(
    offers: list[Qos], reliability: str, durability: str
) -> None:
    found = offer_beyond(QosWish(), offers)
    assert (found.reliability, found.durability) == (reliability, durability)


def test_the_entry_sets_what_is_offered_beyond() -> None:
    wish = QosWish(reliability="best_effort", durability="volatile", depth=3, history="keep_all")
    found = offer_beyond(wish, [LATCHED])
    assert (found.reliability, found.durability) == ("best_effort", "volatile")
    assert (found.depth, found.history) == (3, "keep_all")


@pytest.mark.parametrize(
    ("offer", "depth"),
    [(LATCHED, 1), (LATCHED.with_depth(7), 7), (RELIABLE, 10), (RELIABLE.with_depth(7), 10)],
)
def test_the_depth_of_what_is_latched_is_the_publishers(offer: Qos, depth: int) -> None:
    assert offer_beyond(QosWish(), [offer]).depth == depth


def test_what_is_latched_keeps_all_where_its_publisher_does() -> None:
    latched = Qos(durability="transient_local", history="keep_all")
    assert offer_beyond(QosWish(), [latched]).history == "keep_all"
    assert offer_beyond(QosWish(), [Qos(history="keep_all")]).history == "keep_last"


@pytest.mark.parametrize(
    ("wish", "offer", "expected"),
    [
        (QosWish(), Qos(depth=1), 10),
        (QosWish(), Qos(depth=30), 30),
        (QosWish(depth=1), Qos(depth=1), 1),
        (QosWish(), Qos(history="keep_all"), None),
    ],
)
def test_room_for_what_waits(wish: QosWish, offer: Qos, expected: int | None) -> None:
    assert room(wish, offer) == expected


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
    found = offer_beyond(QosWish(**{policy: wish}), publishers)
    assert getattr(found, f"{policy}_ns") == expected


def test_a_deadline_that_is_matched_asks_nobody_for_one() -> None:
    assert request(QosWish(deadline=AUTO), Qos(deadline_ns=5)).deadline_ns is None
    assert unmet(QosWish(deadline=4), Qos(deadline_ns=5)) != []


def test_liveliness_is_automatic_unless_asked_for() -> None:
    manual = Qos(liveliness="manual_by_topic", lease_ns=10)
    found = offer_beyond(QosWish(), [manual])
    assert (found.liveliness, found.lease_ns) == ("automatic", None)
    wish = QosWish(liveliness="manual_by_topic", lease=20)
    wished = offer_beyond(wish, [manual])
    assert (wished.liveliness, wished.lease_ns) == ("manual_by_topic", 20)
    assert unmet(wish, manual) == []
    assert unmet(wish, RELIABLE) != []
