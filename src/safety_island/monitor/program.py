# SPDX-License-Identifier: Apache-2.0
"""The monitor as a program: one thread that polls, serves and obeys."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from safety_island import __version__
from safety_island.control.status import LongitudinalState
from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.life_cycle.state import State
from safety_island.monitor.feed import Feed
from safety_island.monitor.fields import FIELDS
from safety_island.monitor.history import SECONDS
from safety_island.monitor.hub import Hub
from safety_island.monitor.scene import vehicle_values
from safety_island.monitor.server import PageServer, Place
from safety_island.params import IslandParameters
from safety_island.platform.interfaces import Clock

NODE_NAME = "island_monitor"
POLL_S = 0.02
"""From one look at the subscriptions to the next: what a screen shows comes no faster."""


@dataclass(frozen=True)
class MonitorOptions:
    """What the command line chooses."""

    domain: int
    where: str
    dds: DdsConfig
    parameters: IslandParameters
    place: Place
    title: str = "safety island"


class Monitor:
    """The page of one island. ``clock`` is the wall clock of its time axis."""

    def __init__(
        self, options: MonitorOptions, clock: Clock, press: Callable[[str], None] | None = None
    ) -> None:
        self._options, self._clock = options, clock
        self._start_ns = clock.wall_ns() - clock.monotonic_ns()
        self.hub = Hub(_hello(options))
        self.server = PageServer(self.hub, options.place, press)

    def now(self) -> float:
        """Wall clock [s] that no one sets while the monitor runs."""
        return (self._start_ns + self._clock.monotonic_ns()) / 1e9

    async def run(
        self,
        is_over: Callable[[], bool],
        on_address: Callable[[str], None],
        between: Callable[[Monitor], None] = lambda monitor: None,
    ) -> None:
        """Serve until it is over. ``on_address`` is told where, ``between`` called at each look.

        Raises IslandError when there is no port or no domain to join.
        """
        given = self._options
        async with self.server.serving():
            with Participant(given.domain, given.dds, NODE_NAME) as participant:
                release = given.parameters.node.autoware_release
                feed = Feed(participant, given.where, release, self.hub)
                on_address(self.server.address)
                while not is_over():
                    feed.poll(self.now())
                    between(self)
                    await asyncio.sleep(POLL_S)


def _hello(options: MonitorOptions) -> dict[str, Any]:
    """Return what a page must know before anything else."""
    return {
        "version": __version__,
        "title": options.title,
        "where": options.where,
        "fields": FIELDS,
        "seconds": SECONDS,
        "vehicle": vehicle_values(options.parameters),
        "states": [state.name for state in State],
        "longitudinal_states": [state.name for state in LongitudinalState],
        "control_topic": topics.CONTROL.name,
    }
