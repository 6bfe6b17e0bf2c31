# SPDX-License-Identifier: Apache-2.0
"""One SNTP exchange over UDP; it moves the island's wall clock, never the machine's."""

from __future__ import annotations

import secrets
import select
import socket

from safety_island.platform.interfaces import Clock
from safety_island.platform.sntp import (
    NotOursError,
    Reply,
    SntpError,
    parse_server,
    read_reply,
    request,
)

TIMEOUT_S = 3.0


def synchronise(clock: Clock, server: str, timeout_s: float = TIMEOUT_S) -> Reply:
    """Ask a server once and set the wall clock's offset over the monotonic clock.

    ``server``: ``HOST`` or ``HOST:PORT``. Raises ConfigurationError for another text, SntpError
    with the server's name and the reason; the clock is then as it was.
    """
    host, port = parse_server(server)
    try:
        reply = _exchange(clock, host, port, timeout_s)
    except SntpError as error:
        raise SntpError(
            f"no time from SNTP server '{server}': {error}; name another with --sntp, or set "
            "CONFIG_ENABLE_SNTP=n to use the machine's clock"
        ) from error
    clock.set_wall_offset_ns(reply.offset_ns)
    return reply


def _exchange(clock: Clock, host: str, port: int, timeout_s: float) -> Reply:
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
    except (OSError, UnicodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no host name"
        raise SntpError(f"the name cannot be resolved ({reason})") from error
    try:
        with socket.socket(family, socket.SOCK_DGRAM) as channel:
            channel.connect(address)  # from now on only this address is heard
            channel.setblocking(False)
            return _ask(clock, channel, timeout_s)
    except OSError as error:
        raise SntpError(str(error.strerror or error)) from error


def _ask(clock: Clock, channel: socket.socket, timeout_s: float) -> Reply:
    """Send the request, and pass over what comes and does not belong to it."""
    cookie = secrets.randbits(64) or 1
    sent_ns = clock.monotonic_ns()
    channel.send(request(cookie))
    end_ns = sent_ns + round(timeout_s * 1e9)
    refused = ""
    while (left_ns := end_ns - clock.monotonic_ns()) > 0:
        if not select.select((channel,), (), (), left_ns / 1e9)[0]:
            break
        received_ns = clock.monotonic_ns()
        try:
            data = channel.recv(1024)
        except BlockingIOError:  # a datagram with a wrong checksum
            continue
        try:
            return read_reply(data, cookie, sent_ns, received_ns)
        except NotOursError as error:
            refused = f"; {error}"
    raise SntpError(f"no answer within {timeout_s:g} s{refused}")
