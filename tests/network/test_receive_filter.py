# SPDX-License-Identifier: Apache-2.0
"""An interface is a limit: what comes in over another one is dropped by the kernel.

Datagrams are forged in the name of a real writer, with the GUID and the number that the reader
waits for, so the reader obeys the first that reaches it.
"""

from __future__ import annotations

from tests.interop.namespace import Namespace, Running
from tests.network.conftest import Machine

DOMAIN = "2"
VEHICLE, STRANGER = "192.168.77.2", "192.168.77.3"
ASIDE, STRANGER_ASIDE = "192.168.88.2", "192.168.88.3"


def start(machine: Namespace, *arguments: str) -> Running:
    return machine.island("tests.network.peer", *arguments)


def received(receiver: Running) -> str:
    return str(receiver.expect(lambda line: line.removeprefix("ports")))


def receiver_on(machine: Namespace, interface: str) -> tuple[Running, list[str]]:
    running = start(machine, "receive", DOMAIN, interface)
    return running, running.expect(lambda line: line.split()[1:])


def published(machine: Namespace, interface: str, angle: str) -> str:
    """Publish on a machine; return the GUID of the writer."""
    return str(start(machine, "publish", DOMAIN, interface, angle).expect(str))


def forge(machine: Namespace, angle: str, guid: str, host: str, ports: list[str]) -> None:
    sent = start(machine, "forge", DOMAIN, "-", angle, guid, host, *ports)
    assert sent.expect(str) == "sent"


def test_row_89_on_loopback_a_datagram_of_another_machine_is_dropped(machine: Machine) -> None:
    vehicle, stranger = machine(), machine()
    vehicle.link("eth0", VEHICLE, stranger, STRANGER)
    receiver, ports = receiver_on(vehicle, "lo")
    guid = published(vehicle, "lo", "0.1")
    assert received(receiver) == "0.1"
    forge(stranger, "0.9", guid, VEHICLE, ports)
    forge(vehicle, "0.2", guid, VEHICLE, ports)
    assert received(receiver) == "0.2"


def test_on_an_interface_peers_there_and_on_this_machine_are_received(machine: Machine) -> None:
    vehicle, other = machine(), machine()
    vehicle.link("eth0", VEHICLE, other, STRANGER)
    receiver, _ = receiver_on(vehicle, "eth0")
    published(other, "eth0", "0.3")
    assert received(receiver) == "0.3"
    published(vehicle, "eth0", "0.4")
    assert received(receiver) == "0.4"


def test_row_89_on_an_interface_a_datagram_over_another_one_is_dropped(machine: Machine) -> None:
    """Linux takes a packet for any of its addresses on any of its interfaces."""
    vehicle, other, stranger = machine(), machine(), machine()
    vehicle.link("eth0", VEHICLE, other, STRANGER)
    vehicle.link("eth1", ASIDE, stranger, STRANGER_ASIDE)
    stranger.run("ip", "route", "add", "192.168.77.0/24", "via", ASIDE)
    receiver, ports = receiver_on(vehicle, "eth0")
    guid = published(other, "eth0", "0.1")
    assert received(receiver) == "0.1"
    forge(stranger, "0.9", guid, VEHICLE, ports)
    forge(stranger, "0.9", guid, ASIDE, ports)
    forge(other, "0.2", guid, VEHICLE, ports)
    assert received(receiver) == "0.2"
