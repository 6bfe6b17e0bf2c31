# SPDX-License-Identifier: Apache-2.0
"""One SNTP exchange as bytes and numbers: the request, and what a reply must be to be believed.

Format: RFC 5905, figure 8. Checks: RFC 5905, sections 7.4 and 8, and RFC 4330, section 5.
"""

from __future__ import annotations

import struct
from typing import NamedTuple

from safety_island.errors import ConfigurationError, IslandError

NTP_PORT = 123
_PACKET = struct.Struct(">BBbbII4sQQQQ")
"""Flags, stratum, poll, precision, root delay, root dispersion, reference id, four times."""
VERSION = 4
_CLIENT, _SERVER = 3, 4
_NOT_SYNCHRONISED = 3
_MAX_STRATUM = 15
MAX_ROUND_TRIP_NS = 500_000_000
"""The offset is known to half the round trip."""
MAX_ROOT_DISTANCE_S = 1.5
"""How far the server may be from true time by its own account (MAXDIST of RFC 5905)."""
_MAX_SURPLUS_NS = 1_000_000
"""So much longer than the whole exchange may the server claim to have held it: coarse clocks."""
EARLIEST_NS = 1_735_689_600_000_000_000
"""2025-01-01: a server that is earlier has lost its time."""
_NTP_TO_UNIX_S = 2_208_988_800
_ERA_S = 1 << 32
_SECOND_NS = 1_000_000_000


class SntpError(IslandError):
    """An SNTP server that did not answer, or whose answer cannot be believed."""


class NotOursError(SntpError):
    """A reply to another request: the one that belongs to this may still come."""


class Reply(NamedTuple):
    """What an exchange tells."""

    offset_ns: int
    """Wall clock minus the clock that the exchange was timed with [ns]."""
    round_trip_ns: int
    """Time on the way, the server's own part taken off [ns]."""
    stratum: int


def request(cookie: int) -> bytes:
    """Return a request; ``cookie``: 64 random bits in place of the time, which is nobody's concern.

    The reply must repeat them, so nobody can forge one who has not seen the request.
    """
    flags = VERSION << 3 | _CLIENT
    return _PACKET.pack(flags, 0, 0, 0, 0, 0, b"", 0, 0, 0, cookie)


def read_reply(data: bytes, cookie: int, sent_ns: int, received_ns: int) -> Reply:
    """Return what a reply tells; the times of sending and receiving are of one clock [ns].

    Raises NotOursError for a reply to something else, SntpError for one that cannot be believed.
    """
    if len(data) < _PACKET.size:
        raise NotOursError(f"the reply has {len(data)} bytes, expected at least {_PACKET.size}")
    flags, stratum, _, _, delay, dispersion, reference, _, origin, arrived, left = _PACKET.unpack(
        data[: _PACKET.size]
    )
    if origin != cookie:
        raise NotOursError("the reply does not repeat what the request said")
    if (flags & 7, flags >> 3 & 7) != (_SERVER, VERSION):
        raise SntpError(
            f"the reply has mode {flags & 7} and version {flags >> 3 & 7}, "
            f"expected {_SERVER} (server) and {VERSION}"
        )
    _check_server(flags >> 6, stratum, reference)
    _check_distance(delay, dispersion)
    return _offset(arrived, left, sent_ns, received_ns, stratum)


def _check_server(leap: int, stratum: int, reference: bytes) -> None:
    if stratum == 0 and reference.isalpha():
        raise SntpError(f"the server sends us away (kiss-o'-death '{reference.decode('ascii')}')")
    if leap == _NOT_SYNCHRONISED:
        raise SntpError("the server says that its own clock is not synchronised (leap indicator 3)")
    if not 1 <= stratum <= _MAX_STRATUM:
        raise SntpError(f"the server has stratum {stratum}, expected 1 to {_MAX_STRATUM}")


def _check_distance(delay: int, dispersion: int) -> None:
    """Check root delay and dispersion, fixed point with 16 bits after it [s]."""
    distance_s = (delay / 2 + dispersion) / 65536
    if distance_s > MAX_ROOT_DISTANCE_S:
        raise SntpError(
            f"the server is {distance_s:.1f} s from its source, at most {MAX_ROOT_DISTANCE_S} s "
            "can be used"
        )


def _offset(arrived: int, left: int, sent_ns: int, received_ns: int, stratum: int) -> Reply:
    """Weigh the four times of the exchange."""
    if not arrived or not left:
        raise SntpError("the reply holds no time")
    arrived_ns, left_ns = unix_ns(arrived), unix_ns(left)
    if left_ns < arrived_ns:
        raise SntpError("the reply left the server before the request arrived there")
    if left_ns < EARLIEST_NS:
        raise SntpError("the server's time is before 2025: it has lost it")
    round_trip_ns = (received_ns - sent_ns) - (left_ns - arrived_ns)
    if not -_MAX_SURPLUS_NS <= round_trip_ns <= MAX_ROUND_TRIP_NS:
        raise SntpError(
            f"the round trip takes {round_trip_ns / 1e6:.1f} ms by the times of the reply, "
            f"expected 0 to {MAX_ROUND_TRIP_NS / 1e6:.0f} ms"
        )
    offset_ns = ((arrived_ns - sent_ns) + (left_ns - received_ns)) // 2
    return Reply(offset_ns, max(round_trip_ns, 0), stratum)


def unix_ns(time: int) -> int:
    """Return a time of NTP (32 bits of seconds, 32 of their fraction) in ns since 1970.

    The seconds began anew in 2036: without their highest bit they count from there.
    """
    seconds, fraction = time >> 32, time & 0xFFFF_FFFF
    if not seconds & 0x8000_0000:
        seconds += _ERA_S
    return (seconds - _NTP_TO_UNIX_S) * _SECOND_NS + (fraction * _SECOND_NS >> 32)


def parse_server(text: str) -> tuple[str, int]:
    """Read ``HOST``, ``HOST:PORT`` or ``[IPV6]:PORT``; return host and port.

    Raises ConfigurationError.
    """
    host, colon, port = text.rpartition(":")
    if not colon or (":" in host and not host.endswith("]")):  # no port, or a bare IPv6 address
        host, port = text, str(NTP_PORT)
    host = host.removeprefix("[").removesuffix("]")
    is_port = port.isascii() and port.isdigit() and 0 < int(port) < 65536
    if not is_port or not host or not host.isprintable() or " " in host:
        raise ConfigurationError(
            f"SNTP server '{text}': expected a name or an address, with a port after a colon "
            f"when it is not {NTP_PORT}"
        )
    return host, int(port)
