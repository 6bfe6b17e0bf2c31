# SPDX-License-Identifier: Apache-2.0
"""Finds DDS domain ids that nobody on this machine uses.

By the RTPS rule, for every vendor, a participant holds UDP port 7400 + 250 * domain (discovery by
multicast) or that plus 10 + 2 * index (by unicast), so a port that cannot be bound shows a domain
in use. Two demos that start at the same moment are kept apart before that by a Unix
socket with an abstract name: it is no file, belongs to the network namespace as the ports do, and
goes with its process.
"""

from __future__ import annotations

import socket
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager

from safety_island.cli.options import MAX_DOMAIN

PARTICIPANTS = 8
"""How many participant indices of a domain are looked at."""


def in_use(domain: int) -> bool:
    """Whether a DDS participant of this domain runs on this machine."""
    base = 7400 + 250 * domain
    ports = [base, *(base + 10 + 2 * index for index in range(PARTICIPANTS))]
    return not all(_can_bind(port) for port in ports)


def _can_bind(port: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("0.0.0.0", port))
        except OSError:
            return False
    return True


@contextmanager
def reserve(candidates: Iterable[tuple[int, ...]]) -> Iterator[tuple[int, ...] | None]:
    """Reserve the first group of domain ids of which none is in use; None when all groups are.

    The reservation holds against other users of this function for as long as the context lasts.
    """
    for group in candidates:
        with ExitStack() as held:
            if all(_lock(domain, held) and not in_use(domain) for domain in group):
                yield group
                return
    yield None


def pairs_from(first: int, second: int) -> Iterator[tuple[int, int]]:
    """Yield the pair that is wanted, then every higher pair of neighbours."""
    yield first, second
    start = max(first, second) + 1
    for domain in range(start, MAX_DOMAIN, 2):
        yield domain, domain + 1


def _lock(domain: int, held: ExitStack) -> bool:
    """Take the name of a domain; it is let go when ``held`` closes."""
    name = held.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
    try:
        name.bind(f"\0safety-island-domain-{domain}")
    except OSError:
        return False
    return True
