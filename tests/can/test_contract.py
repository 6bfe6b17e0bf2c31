# SPDX-License-Identifier: Apache-2.0
"""What every CAN backend promises; each test runs on each backend that this machine can open.

``udp_multicast`` joins in a network namespace of its own: see ``test_udp_multicast``.
"""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest

from safety_island.can.backends import new_link
from safety_island.can.bus import BusEvent, BusLink, Delivery, EventKind
from safety_island.command.frames import WATCHED_IDS
from safety_island.platform.interfaces import CanFrame, CanResult
from tests.can.peers import PEERS, Peer, open_peer
from tests.can.rig import triple, until

BUDGET_S = 1.0
FOREIGN = CanFrame(0x101, bytes(range(8)))
OTHER = CanFrame(0x555, b"abc")


@pytest.fixture(params=("mock", *PEERS))
def peer(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Peer]:
    with open_peer(request.param, monkeypatch) as opened:
        yield opened


@pytest.fixture
def link(peer: Peer) -> Iterator[BusLink]:
    made = new_link(peer.spec, time.monotonic_ns)
    made.open()
    peer.join(made)
    yield made
    made.close()


def heard(peer: Peer, count: int) -> list[CanFrame]:
    """Wait for frames at the other end."""
    assert until(lambda: len(peer.heard()) >= count), peer.heard()
    return peer.heard()


def test_three_frames_arrive_whole_and_in_order(link: BusLink, peer: Peer) -> None:
    for sequence in range(5):
        assert link.send(triple(sequence), BUDGET_S)[:2] == (3, CanResult.SENT)
        assert heard(peer, 3 * sequence + 3)[-3:] == list(triple(sequence))


def test_own_frames_are_not_foreign(link: BusLink, peer: Peer) -> None:
    for sequence in range(20):
        delivery = link.send(triple(sequence), BUDGET_S)
        assert (delivery.result, list(delivery.events)) == (CanResult.SENT, [])
        heard(peer, 3 * sequence + 3)


@pytest.mark.parametrize("peer", PEERS, indirect=True)
def test_a_foreign_command_frame_is_told_and_others_are_not(link: BusLink, peer: Peer) -> None:
    peer.emit(OTHER)
    peer.emit(FOREIGN)
    found: list[BusEvent] = []

    def told() -> bool:
        found.extend(link.send(triple(), BUDGET_S).events)
        peer.heard()
        return bool(found)

    assert until(told)
    assert [(event.kind, event.arbitration_id) for event in found] == [
        (EventKind.FOREIGN_COMMAND, FOREIGN.arbitration_id)
    ]


@pytest.mark.parametrize("peer", PEERS, indirect=True)
@pytest.mark.parametrize("arbitration_id", sorted(WATCHED_IDS))
def test_a_foreign_command_frame_is_told_without_sending(
    link: BusLink, peer: Peer, arbitration_id: int
) -> None:
    peer.emit(OTHER)
    peer.emit(CanFrame(arbitration_id, bytes(8)))
    found: list[BusEvent] = []

    def told() -> bool:
        found.extend(link.poll())
        peer.heard()
        return bool(found)

    assert until(told)
    assert found == [BusEvent(EventKind.FOREIGN_COMMAND, arbitration_id)]


def test_a_closed_bus_takes_nothing_and_may_be_closed_twice(link: BusLink, peer: Peer) -> None:
    link.close()
    assert link.send(triple(), BUDGET_S) == Delivery(0, CanResult.NOT_OPEN)
    link.close()
    assert peer.heard() == []


def test_after_reopening_only_new_frames_arrive(link: BusLink, peer: Peer) -> None:
    link.send(triple(1), BUDGET_S)
    heard(peer, 3)
    link.reopen()
    assert until(lambda: not link.is_opening)
    assert link.send(triple(2), BUDGET_S).result is CanResult.SENT
    assert heard(peer, 6) == [*triple(1), *triple(2)]


def test_an_empty_budget_sends_nothing(link: BusLink, peer: Peer) -> None:
    assert link.send(triple(), 0.0).result is CanResult.TIMED_OUT
    assert until(lambda: link.send(triple(7), BUDGET_S).result is CanResult.SENT)
    assert heard(peer, 3) == list(triple(7))
