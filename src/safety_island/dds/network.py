# SPDX-License-Identifier: Apache-2.0
"""Questions to the operating system about interfaces and hosts, answered with clear errors."""

from __future__ import annotations

import fcntl
import socket
import struct
from contextlib import suppress
from ipaddress import ip_address

from safety_island.errors import ConfigurationError
from safety_island.words import did_you_mean

LOOPBACK = "lo"
_SIOCGIFFLAGS = 0x8913
_UP = 0x1
_MULTICAST = 0x1000


def interfaces() -> list[str]:
    """Return the names of the network interfaces of this machine."""
    return [name for _, name in socket.if_nameindex()]


def check_exists(name: str) -> None:
    """Raise ConfigurationError unless the interface exists."""
    found = interfaces()
    if name not in found:
        hint = did_you_mean(name, found)
        raise ConfigurationError(
            f"network interface {name!r} does not exist; this machine has"
            f" {', '.join(found)}{hint}. Choose one with --interface or in the configuration"
        )


def check_interface(name: str) -> None:
    """Raise ConfigurationError unless the interface exists and is up."""
    check_exists(name)
    if not is_up(name):
        raise ConfigurationError(f"network interface {name!r} is down; run: ip link set {name} up")


def is_elsewhere(peer: str) -> bool:
    """Return whether a peer is an address of another machine; a name may be any machine's."""
    host = peer.rpartition("/")[2]
    host = host[1:].partition("]")[0] if host.startswith("[") else host
    for text in (host, host.partition(":")[0]):
        with suppress(ValueError):
            address = ip_address(text)
            return not (address.is_loopback or address.is_multicast)
    return False


def unknown_peer(peer: str) -> str:
    """Return the error for a peer that is no address and no name that resolves."""
    return (
        f"DDS peer {peer!r} cannot be resolved; expected an address (192.168.7.2, fd00::2 or"
        " udp/192.168.7.2) or a host name, with an optional :port ([fd00::2]:7410)"
    )


def has_multicast(name: str) -> bool:
    """Return whether an interface carries multicast; loopback does, flag or not."""
    return name == LOOPBACK or bool(flags(name) & _MULTICAST)


def is_up(name: str) -> bool:
    """Return whether an interface is up."""
    return bool(flags(name) & _UP)


def flags(name: str) -> int:
    """Return the flags of an interface; all of them when the kernel does not say."""
    query = struct.pack("16s24x", name.encode())
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as channel:
            return int(struct.unpack_from("=H", fcntl.ioctl(channel, _SIOCGIFFLAGS, query), 16)[0])
    except OSError:
        return _UP | _MULTICAST
