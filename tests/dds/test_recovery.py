# SPDX-License-Identifier: Apache-2.0
"""Loss, partition, stall and restart between two processes, and what comes back by itself."""

from __future__ import annotations

import signal

import pytest

from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.errors import DdsError
from safety_island.dds.faults import isolate
from safety_island.dds.participant import Participant
from safety_island.messages import inputs
from safety_island.messages.wire import Time
from tests.dds.conftest import NewParticipant
from tests.dds.peer import line, peer
from tests.dds.waiting import wait_for

pytestmark = pytest.mark.live
STEERING = topics.STEERING
LONG_ISOLATION_S = 600.0


class Echo:
    """Our ends of the way to an echoing peer and back."""

    def __init__(self, own: Participant) -> None:
        self.own = own
        self.out: Publisher = own.publisher(STEERING.name, STEERING.type_name)
        self.back: Subscription = own.subscription("/back", STEERING.type_name)
        self.number = 0

    def connected(self) -> bool:
        return bool(self.out.matched() and self.back.matched())

    def send(self) -> None:
        self.number += 1
        self.out.write(inputs.encode_steering(inputs.Steering(Time(self.number, 0), 0.0)))

    def works(self) -> bool:
        """Send one more message; true when any has come back since the last call."""
        self.send()
        return self.back.take_newest() is not None


def test_the_newest_arrives_in_order_when_a_fifth_of_the_packets_is_lost(
    participant: NewParticipant, domain_id: int
) -> None:
    """Row 1 of the fault catalogue: depth 1 may skip, but the last one comes, none goes back."""
    echo = Echo(participant(config=DdsConfig(loopback_only=True, loss=0.2)))
    with peer("echo", domain_id) as process:
        assert line(process) == "ready"
        wait_for(echo.works, 30.0)  # both sides have matched, which volatile samples need
        for _ in range(100):
            echo.send()
        seconds: list[int] = []
        while echo.number not in seconds:
            taken = wait_for(lambda: echo.back.take_all() or None, 30.0)
            seconds += [inputs.decode_steering(sample.data).stamp.sec for sample in taken]
    assert seconds == sorted(set(seconds))


def test_a_partition_is_noticed_and_heals(participant: NewParticipant, domain_id: int) -> None:
    """Row 3: the peer is missed within its lease, found again when the network is back."""
    echo = Echo(participant())
    with peer("echo", domain_id) as process:
        assert line(process) == "ready"
        wait_for(echo.works)
        isolate(echo.own, LONG_ISOLATION_S)
        wait_for(lambda: not echo.own.publications("/back"))
        assert not echo.connected()
        isolate(echo.own, 0.001)
        wait_for(echo.connected)
        wait_for(echo.works)


def test_a_stopped_peer_is_missed_and_found_again(
    participant: NewParticipant, domain_id: int
) -> None:
    """SIGSTOP for longer than the lease, then SIGCONT."""
    echo = Echo(participant())
    with peer("echo", domain_id) as process:
        assert line(process) == "ready"
        wait_for(echo.works)
        process.send_signal(signal.SIGSTOP)
        wait_for(lambda: not echo.connected())
        process.send_signal(signal.SIGCONT)
        wait_for(echo.works)


def test_a_killed_peer_is_replaced_by_a_new_one(
    participant: NewParticipant, domain_id: int
) -> None:
    """Row 75: the new process is matched while the old one's lease may still run."""
    echo = Echo(participant())
    seen = set()
    for _ in range(2):
        with peer("echo", domain_id) as process:
            assert line(process) == "ready"
            wait_for(echo.works)
            seen |= {endpoint.guid for endpoint in echo.own.publications("/back")}
            process.kill()
    assert len(seen) == 2
    wait_for(lambda: not echo.connected())


def test_what_cannot_be_cut_off_is_told(participant: NewParticipant) -> None:
    own = participant()
    own.close()
    with pytest.raises(DdsError, match="cannot be cut off"):
        isolate(own, 1.0)
