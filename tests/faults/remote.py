# SPDX-License-Identifier: Apache-2.0
"""The side of the main compute: its clock and its way into the island's domain."""

from __future__ import annotations

from safety_island.dds.qos import Qos
from safety_island.node.memory import MemoryDomain, MemorySubscription
from safety_island.platform.sim.clock import SimClock
from tests.faults.wire import Wire


class RemoteClock(SimClock):
    """The clock of the main compute: the same moments, a wall clock of its own."""

    def __init__(self, island: SimClock) -> None:
        super().__init__()
        self._island = island

    def monotonic_ns(self) -> int:
        return self._island.monotonic_ns()

    def wall_ns(self) -> int:
        return self.monotonic_ns() + self._offset_ns


class Wires(MemoryDomain):
    """The main compute's way into the island's domain."""

    def __init__(self, clock: SimClock, domain: MemoryDomain) -> None:
        super().__init__(clock)
        self._sim_clock, self._domain = clock, domain
        self.by_topic: dict[str, Wire] = {}

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Wire:  # type: ignore[override]
        wire = Wire(self._domain, self._sim_clock, topic, type_name, qos)
        self.by_topic[topic] = wire
        return wire

    def subscription(self, topic: str, type_name: str, qos: Qos) -> MemorySubscription:
        return self._domain.subscription(topic, type_name, qos)
