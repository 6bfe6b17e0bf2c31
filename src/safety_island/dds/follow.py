# SPDX-License-Identifier: Apache-2.0
"""Follows the interfaces of a domain: one that goes and comes back is used again, and told.

CycloneDDS looks at its interfaces once, when a domain starts. An interface that is made anew (a
VPN that was restarted) has another index: the multicast groups that were joined are gone, and the
filters of the sockets name the old one. Another address means that the domain must be joined anew,
since all peers know the old one; that is said, and whoever runs the domain does it.
"""

from __future__ import annotations

import socket
import struct
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from ipaddress import IPv4Address, ip_address
from pathlib import Path

from safety_island.dds import network
from safety_island.dds.receive_filter import Sockets, machine_addresses

_GROUPS = Path("/proc/net/igmp")
_LINKS_AND_ADDRESSES = 0x1 | 0x10  # RTMGRP_LINK, RTMGRP_IPV4_IFADDR
_IP_PKTINFO = 8
_ALL_HOSTS = IPv4Address("224.0.0.1")
_started = threading.Event()


class InterfaceSockets:
    """The sockets of a domain and the interfaces that they are closed to all but.

    Raises DdsError when they cannot be closed.
    """

    def __init__(self, sockets: Sockets) -> None:
        self._sockets = sockets
        indices = sockets.interfaces()
        self._addresses = sockets.addresses()
        self._indices = {socket.if_indextoname(index): index for index in indices}
        self._troubles = dict.fromkeys(self._indices, "")
        self._groups = {name: _groups_of(name) for name in self._indices}
        self.has_moved = False
        """Whether an interface has another address in place of the one that peers know."""
        sockets.receive_only_from(indices)

    def add(self, opened: Sockets) -> None:
        """Take in sockets that were opened later."""
        opened.receive_only_from(frozenset(self._indices.values()))
        self._sockets.add(opened)

    def update(self) -> Iterator[str]:
        """Use interfaces again that came back; yield one line for each change."""
        self.has_moved = False
        for name, before in self._troubles.items():
            trouble = self._trouble(name)
            if not trouble:
                self._use(name)
            if trouble != before:
                self._troubles[name] = trouble
                yield f"network interface {name!r} {trouble or 'is back and in use again'}"

    def _trouble(self, name: str) -> str:
        """Say what keeps an interface from being used; empty when nothing does."""
        try:
            index = socket.if_nametoindex(name)
        except OSError:
            return "is gone; waiting for it"
        if not network.is_up(name):
            return "is down; waiting for it"
        found = [address for address, its in machine_addresses() if its == index]
        if self._addresses.isdisjoint(found):
            now = next((a for a in found if ip_address(a).version == 4), None)
            was = ", ".join(sorted(self._addresses))
            if now is None:
                return f"has lost its address {was}; waiting for it"
            self.has_moved = True
            return f"has the address {now} in place of {was}: its domain must be joined anew"
        return ""

    def _use(self, name: str) -> None:
        """Take in an interface that has another index than before."""
        index = socket.if_nametoindex(name)
        if self._indices[name] == index:
            return
        self._indices[name] = index
        self._sockets.receive_only_from(frozenset(self._indices.values()))
        for opened in self._sockets.open():
            self._join(opened, name)

    def _join(self, opened: socket.socket, name: str) -> None:
        """Join the groups anew where it receives, choose the interface where it sends."""
        if opened.family != socket.AF_INET:
            return
        index = struct.pack("=i", self._indices[name])
        if str(opened.getsockname()[0]) in self._addresses:
            opened.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, bytes(8) + index)
            return
        # The library drops what arrived on an index that it does not know; not when it is not told.
        opened.setsockopt(socket.IPPROTO_IP, _IP_PKTINFO, 0)
        for group in self._groups[name]:
            with suppress(OSError):  # joined already
                member = group.packed + bytes(4) + index
                opened.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)


def follow(changed: Callable[[], None]) -> None:
    """Call a function whenever the kernel announces a change, from a thread that sleeps meanwhile.

    Once for the whole process. A sandbox may forbid it: then nothing is followed.
    """
    if _started.is_set():
        return
    _started.set()
    with suppress(OSError):
        channel = socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, socket.NETLINK_ROUTE)
        channel.bind((0, _LINKS_AND_ADDRESSES))
        listening = (channel, changed)
        threading.Thread(target=_listen, args=listening, name="interfaces", daemon=True).start()


def _listen(channel: socket.socket, changed: Callable[[], None]) -> None:
    while True:
        with suppress(OSError):  # the kernel dropped some announcements: look anyway
            channel.recv(65536)
        changed()


def _groups_of(name: str) -> list[IPv4Address]:
    """Return the multicast groups that this machine joined on an interface."""
    found: list[IPv4Address] = []
    device = ""
    with suppress(OSError):  # a kernel without multicast
        for line in _GROUPS.read_text().splitlines()[1:]:
            words = line.split()
            if not line.startswith("\t"):
                device = words[1]
            elif device == name:
                found.append(IPv4Address(struct.pack("=I", int(words[0], 16))))
    return [group for group in found if group != _ALL_HOSTS]
