# SPDX-License-Identifier: Apache-2.0
"""To which publishers of its topic a route keeps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from safety_island.bridge.config_file import Keep
from safety_island.dds.discovery import RemoteEndpoint

NodeOf = Callable[[RemoteEndpoint], str]
"""Returns the full name of a publisher's node, empty when it is not known."""


@dataclass(frozen=True)
class Kept:
    """The publishers that are forwarded, and those that are not because of ``keep``."""

    forwarded: tuple[RemoteEndpoint, ...] = ()
    others: tuple[RemoteEndpoint, ...] = ()


def keep(wish: Keep, found: Sequence[RemoteEndpoint], before: Kept, node_of: NodeOf) -> Kept:
    """Choose among the publishers that are there, oldest first; ``before`` is the last choice.

    The one that is kept to stays so as long as it lives; then the oldest of those that may follow.
    """
    if wish == Keep():
        return Kept(tuple(found))
    allowed = [endpoint for endpoint in found if _is_meant(wish.publisher, endpoint, node_of)]
    stays = [one for one in allowed if any(_is_same(one, old) for old in before.forwarded)]
    chosen = (stays or allowed)[:1]
    if wish.publisher and wish.second == "forward":
        chosen = allowed
    others = tuple(endpoint for endpoint in found if endpoint not in chosen)
    if wish.second == "silent" and others:
        return Kept((), tuple(found))
    return Kept(tuple(chosen), others)


def _is_meant(name: str, endpoint: RemoteEndpoint, node_of: NodeOf) -> bool:
    if name.startswith("/"):
        return node_of(endpoint) == name
    return name in ("", endpoint.guid.hex())


def _is_same(one: RemoteEndpoint, other: RemoteEndpoint) -> bool:
    """Whether it is the same publisher and did not leave in between."""
    return (one.guid, one.number) == (other.guid, other.number)
