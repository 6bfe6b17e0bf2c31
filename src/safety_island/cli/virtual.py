# SPDX-License-Identifier: Apache-2.0
"""``island run --platform sim``: the vehicle that the node drives in virtual time."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import cast

from safety_island.cli.jsonlines import JsonLines
from safety_island.cli.tell import tell
from safety_island.node.transport import Transport
from safety_island.platform import Platform
from safety_island.platform.sim import SimPlatform
from safety_island.sim.courses import DEFAULT_COURSE, Course, load_course
from safety_island.sim.main_compute import PERIOD_NS, PLAN_EVERY, MainCompute
from safety_island.sim.own_path import read_course
from safety_island.sim.world import World


def course_of(arguments: argparse.Namespace) -> Course:
    """Return the course that ``--course`` or ``--path`` names. Raises ConfigurationError."""
    if arguments.path is not None:
        return read_course(arguments.path)
    return load_course(arguments.course or DEFAULT_COURSE)


class VirtualVehicle:
    """A main compute on the node's own clock and topics; ``on_end`` is called at its last stop."""

    def __init__(
        self,
        platform: Platform,
        transport: Transport,
        on_end: Callable[[], None],
        course: Course,
    ) -> None:
        self._platform = cast(SimPlatform, platform)
        self._clock = self._platform.clock
        self._on_end = on_end
        self._rounds = 0
        start = self._clock.monotonic_ns() * 1e-9
        self.world = World(course, start)
        self._main_compute = MainCompute(self.world, transport, self._clock)
        self._act()

    def _act(self) -> None:
        """Take the newest command, move on, publish, and come again in one period."""
        now = self._clock.monotonic_ns() * 1e-9
        self._main_compute.take_command()
        self.world.advance(now)
        if self.world.has_ended(now):
            self._on_end()
            return
        self._main_compute.publish_vehicle()
        if self._rounds % PLAN_EVERY == 0:
            self._main_compute.publish_plan()
        self._rounds += 1
        self._clock.call_at(self._clock.monotonic_ns() + PERIOD_NS, self._act)

    def finish(self, lines: JsonLines | None) -> None:
        """Tell what was logged in virtual time and how the drive went."""
        if lines is not None:
            lines.write("vehicle", self.world.summary())
        place, metrics = self.world.planner.place, self.world.metrics
        self._platform.logger.info(
            "virtual drive of %.1f m: lateral error at most %.3f m, top speed %.2f m/s, %d stops",
            place.station,
            metrics.max_lateral_error,
            metrics.top_speed,
            len(metrics.stop_errors),
        )
        for line in self._platform.logger.lines:
            tell(line.rstrip())
