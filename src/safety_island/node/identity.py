# SPDX-License-Identifier: Apache-2.0
"""Who else is in the domain: other islands, publishers of our inputs, and who does not match."""

from __future__ import annotations

import math
from collections.abc import Sequence

from safety_island.dds import topics
from safety_island.input_gate.writers import WINDOW_S, Writers
from safety_island.kernel.records import Records
from safety_island.life_cycle.life_cycle import IslandWatch
from safety_island.life_cycle.reason import Reason
from safety_island.node.input_set import InputSet
from safety_island.node.transport import Transport
from safety_island.params import IslandParameters
from safety_island.platform.interfaces import Logger


class Identity:
    """Looks at discovery when it has news. ``own`` holds the GUIDs of our command publishers."""

    def __init__(
        self,
        transport: Transport,
        inputs: InputSet,
        logger: Logger,
        parameters: IslandParameters,
        joined_at: float,
        islands: Records,
    ) -> None:
        """``joined_at`` [s, monotonic]: when the transport entered its domain.

        ``islands``: the memory of other islands (ISLANDS of shape (1,)).
        """
        self.own: set[bytes] = set()
        discovery_s = parameters.life_cycle.discovery_time if transport.needs_discovery else 0.0
        self.islands = IslandWatch(joined_at, discovery_s, islands)
        self._transport, self._inputs, self._logger = transport, inputs, logger
        self._keeps_first = parameters.gate.second_publisher == "keep_first"
        self._others = Writers(parameters.gate.writer_changes)
        self._flaps_until = -math.inf
        self._changes = -1
        self._mismatches: Sequence[str] = ()

    def look(self, now: float) -> None:
        """Take what discovery has found since the last tick [s, monotonic]."""
        changes = self._transport.endpoint_changes()
        if changes == self._changes and not self.islands.looks_around(now):
            return
        self._changes = changes
        entry = topics.CONTROL
        others = self._transport.writers(entry.name, entry.type_name) - self.own
        if others - self.islands.others:
            self._logger.warning("another publisher is on %s", entry.name)
        self.islands.update(others, now)
        self._others.update(others, now)
        if self._others.flaps(now):
            self._flaps_until = now + WINDOW_S
        self._inputs.discover(now)
        self._tell_mismatches()

    def _tell_mismatches(self) -> None:
        """Log each of them once, and not more often than throttled for each topic."""
        before, self._mismatches = self._mismatches, self._transport.mismatches()
        for line in self._mismatches:
            if line not in before:
                topic = line.partition(":")[0]
                self._logger.warning("%s", line, throttled=True, site=f"{topic} mismatch")

    def blocked(self, now: float) -> Reason:
        """Why nothing may be sent because of other islands, NONE when it may."""
        return self.islands.blocked(now <= self._flaps_until, self._keeps_first, now)
