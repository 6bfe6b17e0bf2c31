# SPDX-License-Identifier: Apache-2.0
"""An interface that goes and comes back is used again, and each change is one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from safety_island.dds import topics
from tests.interop.namespace import Namespace, Running
from tests.network.conftest import Machine

DOMAIN = "2"
VEHICLE, OTHER, MOVED = "192.168.77.2", "192.168.77.3", "192.168.77.9"


def is_first_line(line: str) -> bool:
    """Whether a process has just started: the first of its JSON lines has the version."""
    return '"version"' in line


def receiver_on(machine: Namespace) -> Running:
    running = machine.island("tests.network.peer", "receive", DOMAIN, "eth0")
    running.expect(lambda line: line.startswith("ports"))
    return running


def publish(machine: Namespace, angle: str) -> None:
    machine.island("tests.network.peer", "publish", DOMAIN, "eth0", angle)


def ends_with(text: str) -> Callable[[str], bool]:
    return lambda line: line.endswith(text)


def move(vehicle: Namespace) -> None:
    """Give it another address, as a DHCP server does that has forgotten the first."""
    vehicle.run("ip", "address", "del", f"{VEHICLE}/24", "dev", "eth0")
    vehicle.run("ip", "address", "add", f"{MOVED}/24", "dev", "eth0")


def test_row_96_an_interface_that_is_made_anew_is_used_again(machine: Machine) -> None:
    vehicle, other = machine(), machine()
    vehicle.link("eth0", VEHICLE, other, OTHER)
    receiver = receiver_on(vehicle)
    publish(other, "0.1")
    assert receiver.expect(ends_with("0.1"))
    vehicle.run("ip", "link", "del", "eth0")
    assert receiver.expect(ends_with("'eth0' is gone; waiting for it"))
    vehicle.link("eth0", VEHICLE, other, OTHER)
    assert receiver.expect(ends_with("'eth0' is back and in use again"))
    publish(other, "0.2")
    assert receiver.expect(ends_with("0.2"))


def test_row_96_a_network_that_is_down_is_a_few_lines(machine: Machine) -> None:
    """The library alone writes one for every packet: three a second and more."""
    vehicle, other = machine(), machine()
    vehicle.link("eth0", VEHICLE, other, OTHER)
    receiver = receiver_on(vehicle)
    vehicle.run("ip", "link", "set", "eth0", "down")
    assert receiver.expect(ends_with("'eth0' is down; waiting for it"))
    with pytest.raises(AssertionError) as lines:
        receiver.expect(lambda line: False, 3.0)
    assert str(lines.value).count("ddsi_udp_conn_write") <= 1
    vehicle.run("ip", "link", "set", "eth0", "up")
    assert receiver.expect(ends_with("'eth0' is back and in use again"))
    publish(other, "0.4")
    assert receiver.expect(ends_with("0.4"))


def test_row_96_an_address_that_goes_and_comes_back_is_told_and_one_that_changed_too(
    machine: Machine,
) -> None:
    vehicle, other = machine(), machine()
    vehicle.link("eth0", VEHICLE, other, OTHER)
    receiver = receiver_on(vehicle)
    vehicle.run("ip", "address", "del", f"{VEHICLE}/24", "dev", "eth0")
    assert receiver.expect(ends_with(f"'eth0' has lost its address {VEHICLE}; waiting for it"))
    vehicle.run("ip", "address", "add", f"{MOVED}/24", "dev", "eth0")
    moved = f"has the address {MOVED} in place of {VEHICLE}: its domain must be joined anew"
    assert receiver.expect(ends_with(moved))
    vehicle.run("ip", "address", "add", f"{VEHICLE}/24", "dev", "eth0")
    assert receiver.expect(ends_with("'eth0' is back and in use again"))
    publish(other, "0.3")
    assert receiver.expect(ends_with("0.3"))


def test_row_96_the_island_joins_its_domain_anew_with_another_address(machine: Machine) -> None:
    vehicle, other = machine(), machine()
    vehicle.link("eth0", VEHICLE, other, OTHER)
    network = ("--interface", "eth0", "--json")
    island = vehicle.island("safety_island", "run", *network, "--realtime", "off")
    island.expect(is_first_line)
    move(vehicle)
    island.expect(is_first_line)
    status = other.island("safety_island", "status", "--once", *network, "--timeout", "30")
    assert status.expect(lambda line: '"state": "INIT"' in line)


def test_row_96_the_bridge_joins_its_domains_anew_with_another_address(
    machine: Machine, tmp_path: Path
) -> None:
    vehicle, other = machine(), machine()
    vehicle.link("eth0", VEHICLE, other, OTHER)
    (tmp_path / "bridge.yaml").write_text(
        "{name: bridge, from_domain: 1, to_domain: 2, topics:"
        f" {{{topics.STEERING.name}: {{type: {topics.STEERING.type_name}}}}}}}\n"
    )
    file = str(tmp_path / "bridge.yaml")
    words = ("--interface", "eth0", "--json", "--realtime", "off")
    bridge = vehicle.island("safety_island", "bridge", file, *words)
    bridge.expect(is_first_line)
    move(vehicle)
    bridge.expect(is_first_line)
    receiver = receiver_on(other)
    other.island("tests.network.peer", "publish", "1", "eth0", "0.5")
    assert receiver.expect(ends_with("0.5"))
