# SPDX-License-Identifier: Apache-2.0
"""Quality of service in few words, and the profiles that Autoware uses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

Reliability = Literal["reliable", "best_effort"]
Durability = Literal["volatile", "transient_local"]
History = Literal["keep_last", "keep_all"]
Liveliness = Literal["automatic", "manual_by_topic"]

MAX_BLOCKING_NS = 30_000_000
"""Longest time [ns] that a reliable write may wait; it holds up every Python thread."""
INFINITE_NS = 2**63 - 1


@dataclass(frozen=True)
class Qos:
    """Policies of one endpoint; durations in nanoseconds, None is infinite.

    ``depth`` counts samples and matters for ``keep_last`` only.
    """

    reliability: Reliability = "reliable"
    durability: Durability = "volatile"
    depth: int = 1
    history: History = "keep_last"
    deadline_ns: int | None = None
    lifespan_ns: int | None = None
    liveliness: Liveliness = "automatic"
    lease_ns: int | None = None

    def with_depth(self, depth: int) -> Qos:
        """Return the same policies with another history depth."""
        return replace(self, depth=depth)


DEFAULT = Qos()
"""Autoware's usual profile: reliable, volatile, depth 1."""
LATCHED = Qos(durability="transient_local")
"""For states that are sent on change: a late joiner still receives the last one."""
INPUT_DEPTH = 64
"""Samples that a subscription keeps between two ticks, so that what it drops can be counted."""
