# SPDX-License-Identifier: Apache-2.0
"""What an SNTP reply must be to be believed."""

from __future__ import annotations

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety_island.errors import ConfigurationError
from safety_island.platform.sntp import (
    EARLIEST_NS,
    MAX_ROUND_TRIP_NS,
    NotOursError,
    SntpError,
    parse_server,
    read_reply,
    request,
    unix_ns,
)

COOKIE = 0x0123_4567_89AB_CDEF
SENT_NS = 5_000_000_000
WALL_NS = 1_790_000_000_000_000_000
"""What the server's clock shows when the monotonic clock is at 0."""


def ntp(wall_ns: int) -> int:
    """A time in the server's format, rounded up to its next step."""
    seconds, rest = divmod(wall_ns, 10**9)
    return ((seconds + 2_208_988_800) % 2**32 << 32) + -(-rest * 2**32 // 10**9)


def packet(
    *,
    leap: int = 0,
    version: int = 4,
    mode: int = 4,
    stratum: int = 2,
    delay: int = 0,
    dispersion: int = 0,
    reference: bytes = b"GPS",
    origin: int = COOKIE,
    arrived: int | None = None,
    left: int | None = None,
) -> bytes:
    """A reply of a server that got the request after 2 ms and held it for 1 ms."""
    flags = leap << 6 | version << 3 | mode
    arrived = ntp(WALL_NS + SENT_NS + 2_000_000) if arrived is None else arrived
    left = ntp(WALL_NS + SENT_NS + 3_000_000) if left is None else left
    head = struct.pack(">BBbbII4s", flags, stratum, 6, -20, delay, dispersion, reference)
    return head + struct.pack(">QQQQ", 0, origin, arrived, left)


def test_request_is_that_of_a_client_and_tells_no_time() -> None:
    data = request(COOKIE)
    assert len(data) == 48
    assert data[0] == 0b00_100_011
    assert data[1:40] == bytes(39)
    assert data[40:] == COOKIE.to_bytes(8, "big")


def test_offset_and_round_trip() -> None:
    reply = read_reply(packet(), COOKIE, SENT_NS, SENT_NS + 5_000_000)
    assert reply.offset_ns == pytest.approx(WALL_NS, abs=2)
    assert reply.round_trip_ns == pytest.approx(4_000_000, abs=2)
    assert reply.stratum == 2


def test_longer_reply_is_read_too() -> None:
    read_reply(packet() + bytes(20), COOKIE, SENT_NS, SENT_NS + 5_000_000)


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (packet(mode=3), "mode 3"),
        (packet(mode=5), "mode 5"),
        (packet(version=3), "version 3"),
        (packet(leap=3), "not synchronised"),
        (packet(stratum=0, reference=b"RATE"), "kiss-o'-death 'RATE'"),
        (packet(stratum=0, leap=3, reference=b"DENY"), "kiss-o'-death 'DENY'"),
        (packet(stratum=0, leap=3, reference=b""), "not synchronised"),
        (packet(stratum=0, reference=b"\xff\x00"), "stratum 0"),
        (packet(stratum=16), "stratum 16"),
        (packet(delay=4 << 16), "2.0 s from its source"),
        (packet(dispersion=2 << 16), "2.0 s from its source"),
        (packet(arrived=0), "no time"),
        (packet(left=0), "no time"),
        (packet(left=ntp(WALL_NS + SENT_NS)), "before the request arrived"),
        (packet(arrived=ntp(EARLIEST_NS - 2), left=ntp(EARLIEST_NS - 1)), "before 2025"),
        (packet(left=ntp(WALL_NS + SENT_NS + 10_000_000)), "round trip takes -3.0 ms"),
    ],
)
def test_refused(data: bytes, text: str) -> None:
    with pytest.raises(SntpError, match=text) as caught:
        read_reply(data, COOKIE, SENT_NS, SENT_NS + 5_000_000)
    assert not isinstance(caught.value, NotOursError)


def test_long_round_trip_is_refused() -> None:
    late = SENT_NS + 1_000_000 + MAX_ROUND_TRIP_NS
    read_reply(packet(), COOKIE, SENT_NS, late)
    with pytest.raises(SntpError, match="expected 0 to 500 ms"):
        read_reply(packet(), COOKIE, SENT_NS, late + 1_000_000)


@pytest.mark.parametrize("data", [b"", packet()[:47], packet(origin=COOKIE ^ 1), packet(origin=0)])
def test_reply_to_something_else(data: bytes) -> None:
    with pytest.raises(NotOursError):
        read_reply(data, COOKIE, SENT_NS, SENT_NS + 5_000_000)


@given(st.binary(max_size=80))
def test_any_bytes_are_refused_in_words(data: bytes) -> None:
    with pytest.raises(SntpError):
        read_reply(data, COOKIE, SENT_NS, SENT_NS)


@given(st.integers(0, 3), st.integers(0, 7), st.integers(0, 7), st.integers(0, 255))
def test_only_a_server_in_order_is_believed(leap: int, version: int, mode: int, level: int) -> None:
    data = packet(leap=leap, version=version, mode=mode, stratum=level)
    is_good = leap < 3 and version == 4 and mode == 4 and 1 <= level <= 15
    try:
        read_reply(data, COOKIE, SENT_NS, SENT_NS + 5_000_000)
    except SntpError:
        assert not is_good
    else:
        assert is_good


def test_seconds_begin_anew_in_2036() -> None:
    assert unix_ns(0xFFFF_FFFF << 32) == 2_085_978_495 * 10**9
    assert unix_ns(0) == 2_085_978_496 * 10**9
    assert unix_ns(0x8000_0000 << 32 | 0x8000_0000) == (2**31 - 2_208_988_800) * 10**9 + 5 * 10**8


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("pool.ntp.org", ("pool.ntp.org", 123)),
        ("10.0.0.1:1123", ("10.0.0.1", 1123)),
        ("::1", ("::1", 123)),
        ("[::1]", ("::1", 123)),
        ("[fe80::1%eth0]:124", ("fe80::1%eth0", 124)),
    ],
)
def test_server(text: str, expected: tuple[str, int]) -> None:
    assert parse_server(text) == expected


@pytest.mark.parametrize("text", ["", ":", ":123", "a:", "a:0", "a:65536", "a:b", "a b", "a\n"])
def test_server_that_is_none(text: str) -> None:
    with pytest.raises(ConfigurationError, match="expected a name or an address"):
        parse_server(text)
