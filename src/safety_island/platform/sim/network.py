# SPDX-License-Identifier: Apache-2.0
"""Interfaces that exist in virtual time."""

from __future__ import annotations

from collections.abc import Callable
from ipaddress import IPv4Address, IPv4Interface

from safety_island.platform.interfaces import NetworkError
from safety_island.platform.sim.clock import SimClock

STEP_NS = 10_000_000


def _never() -> bool:
    return False


class SimNetwork:
    """A table of interfaces and addresses; ``sim0`` is there from the start.

    An address that comes later is an action of the clock that sets it here. Links, routes and
    packets are not modelled.
    """

    def __init__(self, clock: SimClock) -> None:
        self._clock = clock
        self.addresses: dict[str, str | None] = {"sim0": "10.0.0.1"}

    def address(self, interface: str) -> str | None:
        """IPv4 address of the interface; None when it has none or does not exist."""
        return self.addresses.get(interface)

    def describe(self, interface: str) -> str:
        """What the table says of the interface."""
        if interface not in self.addresses:
            names = ", ".join(sorted(self.addresses))
            return f"there is no such interface; this simulation has {names}"
        address = self.addresses[interface]
        return f"it has the IPv4 address {address}" if address else "it has no IPv4 address"

    def configure(
        self,
        interface: str,
        vlan: int,
        address: IPv4Interface | None,
        gateway: IPv4Address | None,
    ) -> str:
        """Note the address of the interface, or of a new VLAN of it; routes are not modelled."""
        if interface not in self.addresses:
            raise NetworkError(f"interface '{interface}': {self.describe(interface)}")
        name = f"{interface}.{vlan}" if vlan else interface
        self.addresses.setdefault(name, None)
        if address is not None:
            self.addresses[name] = str(address.ip)
        return name

    def wait_for_address(
        self, interface: str, limit_s: float, stopped: Callable[[], bool] = _never
    ) -> str | None:
        """Address of the interface, looked for every 10 ms of virtual time; None when stopped."""
        end_ns = self._clock.monotonic_ns() + round(limit_s * 1e9)
        while not stopped():
            address = self.address(interface)
            if address is not None:
                return address
            if self._clock.monotonic_ns() >= end_ns:
                raise NetworkError(
                    f"interface '{interface}' has no IPv4 address after {limit_s:g} s "
                    f"({self.describe(interface)})"
                )
            self._clock.advance_to_ns(min(self._clock.monotonic_ns() + STEP_NS, end_ns))
        return None
