# SPDX-License-Identifier: Apache-2.0
"""The platform of virtual time: one thread, no wall clock, no sockets, the same result always."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from safety_island.platform.interfaces import LogConfig, Platform
from safety_island.platform.sim.can import MemoryCan
from safety_island.platform.sim.clock import SimClock
from safety_island.platform.sim.logger import MemoryLogger
from safety_island.platform.sim.network import SimNetwork
from safety_island.platform.sim.process import on_stop
from safety_island.platform.sim.timer import SimTimer


@dataclass(frozen=True)
class SimPlatform(Platform):
    """The platform with the types that let a simulation move it."""

    clock: SimClock
    logger: MemoryLogger
    network: SimNetwork
    new_timer: Callable[[float], SimTimer]
    new_can: Callable[[str], MemoryCan]


def make(log: LogConfig | None = None) -> SimPlatform:
    """Return a platform whose virtual time starts at 1000 s and whose log stays in memory."""
    clock = SimClock()
    return SimPlatform(
        name="sim",
        clock=clock,
        logger=MemoryLogger(clock, log or LogConfig()),
        network=SimNetwork(clock),
        new_timer=lambda period_s: SimTimer(clock, period_s),
        new_can=lambda interface: MemoryCan(clock, interface),
        memory_bytes=lambda: 0,
        on_stop=on_stop,
    )
