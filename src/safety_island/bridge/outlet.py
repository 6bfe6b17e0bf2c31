# SPDX-License-Identifier: Apache-2.0
"""A publisher of the bridge in the target domain, and what it owes to those who just found it."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from safety_island.dds.endpoints import Publisher

HOLD_S = 0.1
"""Time [s] for which a new publisher holds its samples, so that known readers find it first."""


@dataclass
class Counts:
    """What became of the samples of a route."""

    forwarded: int = 0
    bytes: int = 0
    superseded: int = 0
    """Waited and were dropped for newer ones of the same publisher."""
    foreign: int = 0
    """Came from a publisher that the route does not keep to."""
    refused: int = 0
    """Could not be compressed or restored."""
    failed: int = 0
    """Were not taken by the publisher."""


class Outlet:
    """Publishes for one latched publisher, or for all others together.

    ``users`` are the numbers of the publishers that it speaks for; ``room`` as in ``matching``.
    Times in s, monotonic.
    """

    def __init__(
        self,
        publisher: Publisher,
        room: int | None,
        ready_at: float,
        counts: Counts,
        on_failure: Callable[[str], None],
    ) -> None:
        self.qos = publisher.qos
        self.room = room
        self.users: set[int] = set()
        self.used = False
        """Whether something was ever given to it."""
        self.stands = False
        """Whether what it sent last still counts: it was not disposed."""
        self.ready_at = ready_at
        self._publisher = publisher
        self._held: deque[bytes] = deque()
        self._counts = counts
        self._on_failure = on_failure

    @property
    def is_latched(self) -> bool:
        """Whether it keeps its last samples for late readers; then it has one user only."""
        return self.qos.durability == "transient_local"

    @property
    def holds(self) -> bool:
        """Whether samples wait for readers to find it."""
        return bool(self._held)

    def send(self, data: bytes, now: float) -> None:
        """Publish a sample, or hold it until readers have found this publisher."""
        self.used = self.stands = True
        if now >= self.ready_at:
            self._publish(data)
            return
        if len(self._held) == (self.qos.depth if self.is_latched else self.room):
            self._held.popleft()
            self._counts.superseded += 1
        self._held.append(data)

    def flush(self, now: float) -> None:
        """Publish what was held, when it is time."""
        while self._held and now >= self.ready_at:
            self._publish(self._held.popleft())

    def dispose(self) -> None:
        """Pass on that the publisher has disposed what it sent last."""
        self._counts.superseded += len(self._held)
        self._held.clear()
        if self.stands:
            self.stands = False
            self._publisher.withdraw()

    def close(self) -> None:
        """Leave the topic: readers beyond find that the publisher is gone."""
        self._publisher.close()

    def _publish(self, data: bytes) -> None:
        if not self._publisher.write(data):
            self._counts.failed += 1
            self._on_failure(self._publisher.last_error)
            return
        self._counts.forwarded += 1
        self._counts.bytes += len(data)
