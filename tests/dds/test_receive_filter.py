# SPDX-License-Identifier: Apache-2.0
"""The filter itself; what it lets through on a network is in tests/network."""

from __future__ import annotations

import errno
import os
import socket
from pathlib import Path

import pytest

from safety_island.dds import receive_filter
from safety_island.dds.config import URI, DdsConfig
from safety_island.dds.errors import DdsError
from safety_island.dds.participant import Participant
from safety_island.dds.receive_filter import Sockets, opened_sockets
from tests.dds.conftest import LOOPBACK

LOOPBACK_INDEX = socket.if_nametoindex("lo")
NOWHERE = 0x7FFF
SO_GET_FILTER = 26


def udp(address: str) -> socket.socket:
    family = socket.AF_INET6 if ":" in address else socket.AF_INET
    opened = socket.socket(family, socket.SOCK_DGRAM)
    opened.bind((address, 0))
    opened.settimeout(0.2)
    return opened


def test_only_sockets_of_the_block_are_found() -> None:
    with udp("127.0.0.1"), opened_sockets() as found, udp("127.0.0.1") as inside:
        pass
    assert found.descriptors == []
    with opened_sockets() as found:
        inside = udp("127.0.0.1")
    assert found.descriptors == [inside.fileno()]
    inside.close()


@pytest.mark.parametrize("address", ["127.0.0.1", "::1"])
def test_the_interface_in_use_is_that_of_the_address_it_sends_from(address: str) -> None:
    with opened_sockets() as found:
        sender, receiver = udp(address), udp("::" if ":" in address else "0.0.0.0")
    with sender, receiver:
        assert found.interfaces() == {LOOPBACK_INDEX}


def test_sockets_without_a_known_interface_are_an_error() -> None:
    with opened_sockets() as found:
        receiver = udp("0.0.0.0")
    with receiver, pytest.raises(DdsError, match="on no interface of this machine"):
        found.interfaces()


def test_the_filter_drops_by_the_interface_of_arrival(monkeypatch: pytest.MonkeyPatch) -> None:
    with udp("127.0.0.1") as receiver, udp("127.0.0.1") as sender:
        found = Sockets(dict(receive_filter._sockets()))
        found.receive_only_from(frozenset({NOWHERE}))
        sender.sendto(b"over loopback", receiver.getsockname())
        assert receiver.recv(100) == b"over loopback"
        monkeypatch.setattr(socket, "if_nametoindex", lambda _: NOWHERE)
        found.receive_only_from(frozenset())
        sender.sendto(b"over loopback", receiver.getsockname())
        with pytest.raises(TimeoutError):
            receiver.recv(100)


@pytest.mark.parametrize("config", [LOOPBACK, DdsConfig()])
def test_a_domain_that_cannot_be_closed_to_others_does_not_start(
    config: DdsConfig, domain_id: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EPERM, "Operation not permitted")

    with monkeypatch.context() as sandbox:
        sandbox.setattr(receive_filter, "_attach", refuse)
        with pytest.raises(DdsError) as refused:
            Participant(domain_id, config)
    assert "SO_ATTACH_FILTER: Operation not permitted" in str(refused.value)
    assert "\n" not in str(refused.value)
    with Participant(domain_id, config) as own:
        assert own.guid


def test_a_domain_whose_sockets_cannot_be_found_does_not_start(
    domain_id: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(receive_filter, "_DESCRIPTORS", tmp_path / "nowhere")
    with pytest.raises(DdsError, match="mount /proc"):
        Participant(domain_id, LOOPBACK)


EACH_PARTICIPANT_ITS_OWN = """<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo"/>
</Interfaces><AllowMulticast>false</AllowMulticast></General><Compatibility>
<ManySocketsMode>many</ManySocketsMode></Compatibility></Domain></CycloneDDS>"""


def test_the_sockets_of_every_participant_are_closed_too(
    domain_id: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(URI, EACH_PARTICIPANT_ITS_OWN)
    with Participant(domain_id), Participant(domain_id):
        descriptors = [number for number, _ in receive_filter._sockets()]
        closed = [_has_filter(number) for number in descriptors]
    assert len(closed) > 3 and all(closed)


def _has_filter(descriptor: int) -> bool:
    with socket.socket(fileno=os.dup(descriptor)) as opened:
        if opened.family not in (socket.AF_INET, socket.AF_INET6):
            return True
        return bool(opened.getsockopt(socket.SOL_SOCKET, SO_GET_FILTER, 64))
