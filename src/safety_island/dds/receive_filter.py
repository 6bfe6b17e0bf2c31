# SPDX-License-Identifier: Apache-2.0
"""Closes the library's sockets to every network interface but those that it uses.

CycloneDDS binds its receiving sockets to 0.0.0.0 whatever interface it is given, so without this
an island on loopback would obey datagrams of other machines. A classic BPF filter on each socket
lets the kernel drop what came in over another interface; it needs no privilege. Loopback is always
let in: what another process of this machine sends to any of its addresses arrives there.
"""

from __future__ import annotations

import ctypes as ct
import fcntl
import os
import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from ipaddress import IPv6Address, ip_address
from pathlib import Path

from safety_island.dds.errors import DdsError
from safety_island.dds.network import LOOPBACK

_DESCRIPTORS = Path("/proc/self/fd")
_IPV6_ADDRESSES = Path("/proc/net/if_inet6")
_IP = (socket.AF_INET, socket.AF_INET6)
_SO_ATTACH_FILTER = 26
_SIOCGIFCONF = 0x8912
_IFREQ = struct.Struct("=16s4x4s16x" if ct.sizeof(ct.c_void_p) == 8 else "=16s4x4s8x")
_MOST_ADDRESSES = 1024
_LOAD, _JUMP_EQUAL, _RETURN = 0x20, 0x15, 0x06  # BPF_LD|BPF_W|BPF_ABS, BPF_JMP|BPF_JEQ, BPF_RET
_ARRIVAL_INTERFACE = 0xFFFFF000 + 8  # SKF_AD_OFF + SKF_AD_IFINDEX
_ALL_BYTES = 0xFFFFFFFF


class Sockets:
    """The network sockets that the library opened during one call."""

    def __init__(self, identities: dict[int, str] | None = None) -> None:
        """``identities``: descriptors and what the kernel calls the sockets behind them."""
        self._identities = dict(identities or {})

    @property
    def descriptors(self) -> list[int]:
        """Those that still stand for the same sockets."""
        now = dict(_sockets())
        return [number for number, its in self._identities.items() if now.get(number) == its]

    def add(self, others: Sockets) -> None:
        """Take in sockets that were opened later."""
        self._identities |= others._identities

    def interfaces(self) -> frozenset[int]:
        """Return the indices of the interfaces that are in use: those that it transmits on.

        Raises DdsError when there are sockets but no such interface.
        """
        used = self.addresses()
        found = frozenset(index for address, index in machine_addresses() if address in used)
        if not found and any(self.open()):
            raise DdsError(
                "the DDS sockets cannot be closed to other network interfaces: the addresses"
                f" {sorted(used)} that they send from are on no interface of this machine"
            )
        return found

    def receive_only_from(self, interfaces: frozenset[int]) -> None:
        """Drop whatever does not arrive on one of these interfaces or on loopback.

        Raises DdsError when the kernel refuses.
        """
        program = _program(sorted(interfaces | {socket.if_nametoindex(LOOPBACK)}))
        try:
            for opened in self.open():
                _attach(opened, program)
        except OSError as problem:
            raise DdsError(
                "the DDS sockets cannot be closed to other network interfaces"
                f" (SO_ATTACH_FILTER: {problem.strerror}); run the island on a Linux kernel that"
                " allows socket filters, without a sandbox that forbids them"
            ) from None

    def addresses(self) -> set[str]:
        """Return the addresses that they send from."""
        found = {str(opened.getsockname()[0]).partition("%")[0] for opened in self.open()}
        return {address for address in found if not ip_address(address).is_unspecified}

    def open(self) -> Iterator[socket.socket]:
        """Yield the UDP sockets, each as a duplicate that is closed afterwards."""
        for descriptor in self.descriptors:
            with socket.socket(fileno=os.dup(descriptor)) as opened:
                if opened.family in _IP and opened.type == socket.SOCK_DGRAM:
                    yield opened


@contextmanager
def opened_sockets() -> Iterator[Sockets]:
    """Collect the sockets that are opened while the block runs."""
    before = {inode for _, inode in _sockets()}
    found = Sockets()
    yield found
    opened = {number: inode for number, inode in _sockets() if inode not in before}
    found.add(Sockets(opened))


def _sockets() -> Iterator[tuple[int, str]]:
    """Yield descriptor and identity of every socket of this process."""
    try:
        entries = list(_DESCRIPTORS.iterdir())
    except OSError as problem:
        raise DdsError(
            f"the DDS sockets cannot be found ({_DESCRIPTORS}: {problem.strerror});"
            " they could not be closed to other network interfaces; mount /proc"
        ) from None
    for entry in entries:
        with suppress(OSError):  # closed meanwhile
            target = str(entry.readlink())
            if target.startswith("socket:"):
                yield int(entry.name), target


def _program(interfaces: list[int]) -> bytes:
    """Return the filter: load the arrival interface, accept those, drop the rest."""
    count = len(interfaces)
    steps = [(_LOAD, 0, 0, _ARRIVAL_INTERFACE)]
    steps += [(_JUMP_EQUAL, count - i, 0, index) for i, index in enumerate(interfaces)]
    steps += [(_RETURN, 0, 0, 0), (_RETURN, 0, 0, _ALL_BYTES)]
    return b"".join(struct.pack("=HBBI", *step) for step in steps)


def _attach(opened: socket.socket, program: bytes) -> None:
    buffer = ct.create_string_buffer(program, len(program))
    described = struct.pack("HP", len(program) // 8, ct.addressof(buffer))
    opened.setsockopt(socket.SOL_SOCKET, _SO_ATTACH_FILTER, described)


def machine_addresses() -> Iterator[tuple[str, int]]:
    """Yield the addresses of this machine with the indices of their interfaces."""
    yield from _ipv4_addresses()
    with suppress(OSError):  # a kernel without IPv6
        for line in _IPV6_ADDRESSES.read_text().splitlines():
            address, index = line.split()[:2]
            yield str(IPv6Address(bytes.fromhex(address))), int(index, 16)


def _ipv4_addresses() -> Iterator[tuple[str, int]]:
    """Ask the kernel for all IPv4 addresses; a label (``eth0:1``) stands for its interface."""
    buffer = ct.create_string_buffer(_MOST_ADDRESSES * _IFREQ.size)
    query = struct.pack("iP", len(buffer), ct.addressof(buffer))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as channel:
        (size,) = struct.unpack_from("i", fcntl.ioctl(channel, _SIOCGIFCONF, query))
    for name, address in _IFREQ.iter_unpack(buffer.raw[:size]):
        interface = name.partition(b"\0")[0].partition(b":")[0].decode()
        with suppress(OSError):  # gone meanwhile
            yield socket.inet_ntoa(address), socket.if_nametoindex(interface)
