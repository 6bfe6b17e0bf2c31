"""Questions to the operating system about interfaces and hosts, answered with clear errors."""

from __future__ import annotations

import socket
from difflib import get_close_matches
from pathlib import Path

from safety_island.errors import ConfigurationError

LOOPBACK = "lo"
_SYSFS = Path("/sys/class/net")
_UP = 0x1


def interfaces() -> list[str]:
    """Return the names of the network interfaces of this machine."""
    return [name for _, name in socket.if_nameindex()]


def check_exists(name: str) -> None:
    """Raise ConfigurationError unless the interface exists."""
    found = interfaces()
    if name not in found:
        near = get_close_matches(name, found, n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise ConfigurationError(
            f"network interface {name!r} does not exist; this machine has"
            f" {', '.join(found)}{hint}. Choose one with --interface or in the configuration"
        )


def check_interface(name: str) -> None:
    """Raise ConfigurationError unless the interface exists and is up."""
    check_exists(name)
    if not _is_up(name):
        raise ConfigurationError(f"network interface {name!r} is down; run: ip link set {name} up")


def check_peer(peer: str) -> None:
    """Raise ConfigurationError unless a peer (``host`` or ``host:port``) resolves to an address.

    The library ends the whole process for a name that does not resolve.
    """
    host, _, port = peer.partition(":")
    try:
        if not host or (port and not 0 < int(port) <= 65535):
            raise ValueError
        socket.getaddrinfo(host, None, socket.AF_INET)
    except (ValueError, OSError):
        raise ConfigurationError(
            f"DDS peer {peer!r} cannot be resolved; expected an IPv4 address or a host name,"
            " with an optional :port"
        ) from None


def _is_up(name: str) -> bool:
    try:
        flags = int((_SYSFS / name / "flags").read_text(), 16)
    except (OSError, ValueError):
        return True
    return bool(flags & _UP)
