# SPDX-License-Identifier: Apache-2.0
"""``island bench loop``: from odometry on the main compute's domain to the ``Control`` back there.

Between the two lies a wait for the next tick, which the period decides and not the program. What
is measured is the rest, in two parts with the same machine clock: the way in (odometry written on
the one domain, through the bridge, to a reader beside the island on the other), and the way out
(start of the tick, which is the command's stamp, to the command read on the first domain).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np

from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.endpoints import Subscription
from safety_island.dds.participant import Participant
from safety_island.dds.qos import DEFAULT
from safety_island.dds.wait_group import WaitGroup
from safety_island.errors import IslandError
from safety_island.messages.outputs import decode_control
from safety_island.platform.posix.clock import PosixClock
from safety_island.sim.courses import DEFAULT_COURSE, load_course
from safety_island.sim.main_compute import PERIOD_NS, PLAN_EVERY, MainCompute
from safety_island.sim.world import World

START_LIMIT_S = 60.0
"""The first command must come by then."""
_SETTLE = 10  # commands that are not counted


class LoopError(IslandError):
    """The loop never closed."""


@dataclass(frozen=True)
class LoopTimes:
    """Times [us] of the way in, the way out and, as the sum of medians, of the whole."""

    commands: int
    in_median_us: float
    in_p99_us: float
    out_median_us: float
    out_p99_us: float
    total_median_us: float

    def as_dict(self) -> dict[str, float]:
        """For JSON."""
        return asdict(self)


class _Loop:
    """The main compute's side, and a reader on the island's."""

    def __init__(self, main: Participant, island: Participant, group: WaitGroup[str]) -> None:
        self.clock = PosixClock()
        start = self.clock.monotonic_ns() * 1e-9
        self.world = World(load_course(DEFAULT_COURSE), start, repeat=True)
        self.main_compute = MainCompute(self.world, main, self.clock)
        self.ways_in: list[float] = []
        self.ways_out: list[float] = []
        self._group = group
        self._written_ns = 0
        self._odometry = self._watch(island, topics.ODOMETRY, "in")
        self._control = self._watch(main, topics.CONTROL, "out")

    def _watch(self, participant: Participant, topic: topics.TopicEntry, way: str) -> Subscription:
        subscription = participant.subscription(topic.name, topic.type_name, DEFAULT)
        self._group.add(subscription, way)
        return subscription

    def round(self, index: int, due_ns: int) -> None:
        """Publish once, then listen until the next round is due."""
        self.world.advance(self.clock.monotonic_ns() * 1e-9)
        if index % PLAN_EVERY == 0:
            self.main_compute.publish_plan()
        self._written_ns = self.clock.monotonic_ns()
        self.main_compute.publish_vehicle()
        while (left := due_ns - self.clock.monotonic_ns()) > 0:
            for way in self._group.wait(left * 1e-9):
                self._take(way)

    def _take(self, way: str) -> None:
        if way == "in":
            arrived_ns = self.clock.monotonic_ns()
            if self._odometry.take_newest() is not None and self._written_ns:
                self.ways_in.append((arrived_ns - self._written_ns) / 1e3)
                self._written_ns = 0
            return
        arrived_ns = self.clock.wall_ns()
        sample = self._control.take_newest()
        if sample is not None:
            stamp = decode_control(sample.data).stamp
            self.ways_out.append((arrived_ns - stamp.nanoseconds) / 1e3)
            self.main_compute.take_command()


def measure(
    domains: tuple[int, int],
    duration_s: float,
    dds: DdsConfig,
    is_alive: Callable[[], bool],
    report: Callable[[int], None],
) -> LoopTimes:
    """Measure for ``duration_s`` [s] from the first command on.

    An island and a bridge run already on ``domains`` (main compute, island); ``is_alive`` tells
    whether they still do, ``report`` is told the number of commands. Raises LoopError when no
    command comes or they end.
    """
    with (
        Participant(domains[0], dds, "main_compute") as main,
        Participant(domains[1], dds, "bench_reader") as island,
        WaitGroup[str]() as group,
    ):
        loop = _Loop(main, island, group)
        _run(loop, duration_s, is_alive, report)
    return _summary(loop)


def _run(
    loop: _Loop, duration_s: float, is_alive: Callable[[], bool], report: Callable[[int], None]
) -> None:
    begin_ns = due_ns = loop.clock.monotonic_ns()
    first_ns: int | None = None
    index = 0
    while first_ns is None or due_ns - first_ns < duration_s * 1e9:
        due_ns += PERIOD_NS
        loop.round(index, due_ns)
        index += 1
        if loop.ways_out and first_ns is None:
            first_ns = due_ns
        report(len(loop.ways_out))
        if not is_alive():
            raise LoopError("the island or the bridge ended before the measurement did")
        if first_ns is None and due_ns - begin_ns > START_LIMIT_S * 1e9:
            raise LoopError(f"no command came within {START_LIMIT_S:.0f} s")


def _summary(loop: _Loop) -> LoopTimes:
    ways_in, ways_out = loop.ways_in[_SETTLE:], loop.ways_out[_SETTLE:]
    if not ways_in or not ways_out:
        raise LoopError("too few commands came to measure anything; measure for longer")
    in_median, out_median = float(np.median(ways_in)), float(np.median(ways_out))
    return LoopTimes(
        len(ways_out),
        in_median,
        float(np.percentile(ways_in, 99)),
        out_median,
        float(np.percentile(ways_out, 99)),
        in_median + out_median,
    )
