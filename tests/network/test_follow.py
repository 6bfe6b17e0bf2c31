# SPDX-License-Identifier: Apache-2.0
"""An interface that goes and comes back is used again, and each change is one line."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.interop.namespace import Namespace, Running
from tests.network.conftest import Machine

DOMAIN = "2"
VEHICLE, OTHER, MOVED = "192.168.77.2", "192.168.77.3", "192.168.77.9"


def receiver_on(machine: Namespace) -> Running:
    running = machine.island("tests.network.peer", "receive", DOMAIN, "eth0")
    running.expect(lambda line: line.startswith("ports"))
    return running


def publish(machine: Namespace, angle: str) -> None:
    machine.island("tests.network.peer", "publish", DOMAIN, "eth0", angle)


def ends_with(text: str) -> Callable[[str], bool]:
    return lambda line: line.endswith(text)


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
    assert receiver.expect(
        ends_with(
            f"has the address {MOVED} in place of {VEHICLE}, which DDS cannot follow; restart"
        )
    )
    vehicle.run("ip", "address", "add", f"{VEHICLE}/24", "dev", "eth0")
    assert receiver.expect(ends_with("'eth0' is back and in use again"))
    publish(other, "0.3")
    assert receiver.expect(ends_with("0.3"))
