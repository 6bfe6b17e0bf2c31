# SPDX-License-Identifier: Apache-2.0
"""Who may read the page and who may press its buttons.

A browser lets any page that it has open talk to this machine's ports. So a request must name this
server as its host (a foreign name that resolves to this machine is refused), a WebSocket must come
from this server's own page, and whatever acts needs a token that only the printed address holds.
"""

from __future__ import annotations

import hmac
from ipaddress import ip_address
from urllib.parse import urlsplit

LOOPBACK_NAMES = ("localhost", "127.0.0.1", "::1")


def is_loopback(address: str) -> bool:
    """Whether an address to bind to is reached from this machine alone."""
    try:
        return ip_address(address).is_loopback
    except ValueError:
        return address == "localhost"


def is_own_host(header: str | None, port: int, *, loopback: bool) -> bool:
    """Whether the Host of a request names this server by an address of its own.

    Bound elsewhere, any literal address may: only a name can be made to point here by others.
    """
    name, found = _split(header or "")
    if name is None or found != port:
        return False
    return name in LOOPBACK_NAMES if loopback else name in LOOPBACK_NAMES or _is_address(name)


def is_own_origin(origin: str | None, host: str | None) -> bool:
    """Whether a WebSocket comes from this server's page; only a browser says where from."""
    return origin is None or origin == f"http://{host}"


def holds(given: object, token: str) -> bool:
    """Whether a token is the right one; with an empty one nobody has it."""
    return bool(token) and isinstance(given, str) and hmac.compare_digest(given, token)


def _split(host: str) -> tuple[str | None, int | None]:
    try:
        parts = urlsplit(f"//{host}")
        return parts.hostname, 80 if parts.port is None else parts.port
    except ValueError:
        return None, None


def _is_address(name: str) -> bool:
    try:
        ip_address(name)
    except ValueError:
        return False
    return True
