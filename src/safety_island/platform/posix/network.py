# SPDX-License-Identifier: Apache-2.0
"""The machine's network interfaces, as the Linux kernel tells them."""

from __future__ import annotations

import fcntl
import select
import socket
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from ipaddress import IPv4Address, IPv4Interface

from safety_island.platform.interfaces import Clock, NetworkError
from safety_island.words import did_you_mean

SIOCGIFFLAGS = 0x8913
SIOCGIFADDR = 0x8915
IFF_UP = 1
IFF_RUNNING = 0x40
LONGEST_NAME = 15
"""IFNAMSIZ without the closing NUL; the kernel would take a cut name for another interface's."""
RTMGRP_LINK = 1
RTMGRP_IPV4_IFADDR = 0x10
LOOK_AGAIN_S = 0.2
"""How often to look even when the kernel announced nothing."""


def _never() -> bool:
    return False


def _ask(request: int, interface: str) -> bytes | None:
    """Answer of an interface ``ioctl`` after the name field; None when there is none."""
    name = interface.encode()
    if len(name) > LONGEST_NAME:
        return None
    query = struct.pack("16s24x", name)
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as channel:
            return fcntl.ioctl(channel.fileno(), request, query)[16:]
    except OSError:
        return None


def _flags(interface: str) -> int:
    """Flags of an interface; those of a good one when the kernel does not say."""
    answer = _ask(SIOCGIFFLAGS, interface)
    return IFF_UP | IFF_RUNNING if answer is None else int(struct.unpack_from("=H", answer)[0])


@contextmanager
def _announcements() -> Iterator[list[socket.socket]]:
    """Open a socket that becomes readable when an address or a link changes.

    A sandbox may forbid it: then there is none, and looking again now and then must do.
    """
    try:
        channel = socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, socket.NETLINK_ROUTE)
    except OSError:
        yield []
        return
    with channel:
        channel.bind((0, RTMGRP_LINK | RTMGRP_IPV4_IFADDR))
        channel.setblocking(False)
        yield [channel]


def _listen(channels: list[socket.socket], timeout_s: float) -> None:
    """Wait for an announcement and forget its text: the question is asked anew."""
    for channel in select.select(channels, (), (), timeout_s)[0]:
        with suppress(OSError):  # nothing more to read, or the kernel dropped some
            while channel.recv(65536):
                pass


class PosixNetwork:
    """Interfaces by name; changes are heard over netlink, not polled for."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock

    def address(self, interface: str) -> str | None:
        """IPv4 address of the interface; None when it has none, is down or does not exist."""
        answer = _ask(SIOCGIFADDR, interface)
        if answer is None or not _flags(interface) & IFF_UP:
            return None
        return socket.inet_ntoa(answer[4:8])

    def describe(self, interface: str) -> str:
        """What the kernel says of the interface."""
        names = [name for _, name in socket.if_nameindex()]
        if interface not in names:
            hint = did_you_mean(interface, names)
            return f"there is no such interface; this machine has {', '.join(sorted(names))}{hint}"
        address = self.address(interface)
        if address is not None:
            return f"it has the IPv4 address {address}"
        flags = _flags(interface)
        if not flags & IFF_UP:
            return "it is down"
        link = "" if flags & IFF_RUNNING else ", its link is down,"
        return f"it is up{link} and has no IPv4 address"

    def configure(
        self,
        interface: str,
        vlan: int,
        address: IPv4Interface | None,
        gateway: IPv4Address | None,
    ) -> str:
        """Give an interface, or a VLAN of it, an address and a default route; needs privileges."""
        from safety_island.platform.posix.network_setup import configure

        if interface not in (name for _, name in socket.if_nameindex()):
            raise NetworkError(f"interface '{interface}': {self.describe(interface)}")
        return configure(interface, vlan, address, gateway)

    def wait_for_address(
        self, interface: str, limit_s: float, stopped: Callable[[], bool] = _never
    ) -> str | None:
        """IPv4 address of the interface, as soon as it has one; None when ``stopped()``."""
        end_ns = self._clock.monotonic_ns() + round(limit_s * 1e9)
        with _announcements() as channels:
            while not stopped():
                address = self.address(interface)
                if address is not None:
                    return address
                left_s = (end_ns - self._clock.monotonic_ns()) * 1e-9
                if left_s <= 0:
                    raise NetworkError(
                        f"interface '{interface}' has no IPv4 address after {limit_s:g} s "
                        f"({self.describe(interface)}): connect it, give it an address, or name "
                        "another interface"
                    )
                _listen(channels, min(left_s, LOOK_AGAIN_S))
        return None
