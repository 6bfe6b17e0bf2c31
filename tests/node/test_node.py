# SPDX-License-Identifier: Apache-2.0
"""The run of a node: garbage collector, transport of the platform, outputs that fail."""

from __future__ import annotations

import gc

import pytest

from safety_island.control.follower import INPUT_NAMES
from safety_island.dds import topics
from safety_island.node.inputs import INPUTS
from safety_island.node.memory import MemoryDomain
from safety_island.node.node import Node, quiet_garbage_collector
from safety_island.node.outputs import TopicWriter
from safety_island.node.transport import open_transport
from safety_island.platform import Tick
from safety_island.platform.sim import make


def test_inputs_have_the_names_of_the_follower_and_the_topics_of_the_table() -> None:
    assert {spec.name for spec in INPUTS} == set(INPUT_NAMES)
    assert {spec.topic for spec in INPUTS} == set(topics.INPUTS)


def test_the_garbage_collector_rests_in_a_run_and_works_again_after_it() -> None:
    states: list[bool] = []

    class Watching(Node):
        def on_tick(self, due: Tick) -> None:
            states.append(gc.isenabled())

    platform = make()
    Watching("watching", platform, MemoryDomain(platform.clock)).run(0.1, duration_s=20.0)
    assert states == [False] * 200
    assert gc.isenabled()


def test_an_exception_leaves_the_garbage_collector_as_it_was() -> None:
    with pytest.raises(KeyError), quiet_garbage_collector():
        raise KeyError("x")
    assert gc.isenabled()
    assert gc.get_freeze_count() == 0


def test_what_comes_before_the_first_tick_costs_no_tick(monkeypatch: pytest.MonkeyPatch) -> None:
    platform = make()
    collect = gc.collect

    def slow_collect(generation: int = 2) -> int:
        platform.clock.advance_to_ns(platform.clock.monotonic_ns() + 900_000_000)
        return collect(generation)

    monkeypatch.setattr(gc, "collect", slow_collect)
    seen: list[Tick] = []

    class First(Node):
        def on_tick(self, due: Tick) -> None:
            seen.append(due)
            self.stop()

    First("first", platform, MemoryDomain(platform.clock)).run(0.1)
    assert [due.skipped for due in seen] == [0]


def test_a_stop_before_the_run_ends_it_at_once() -> None:
    platform = make()

    class Never(Node):
        def on_tick(self, due: Tick) -> None:
            raise AssertionError("no tick was due")

    node = Never("never", platform, MemoryDomain(platform.clock))
    node.stop()
    node.run(0.1)


def test_the_sim_platform_has_topics_in_memory() -> None:
    assert isinstance(open_transport(make(), 2, None, "island"), MemoryDomain)


def test_a_publisher_that_fails_is_counted_and_logged_once() -> None:
    class Broken:
        guid = b""
        failed = 0
        last_error = "no room in time"

        def write(self, data: bytes) -> bool:
            return False

        def withdraw(self) -> None:
            pass

    logger = make().logger
    writer = TopicWriter(topics.CONTROL, Broken(), logger)
    assert [writer.write(b"x") for _ in range(3)] == [False] * 3
    assert writer.failed == 3
    assert len(logger.lines) == 1
    assert "[/control/trajectory_follower/control_cmd] not sent: no room in time" in logger.lines[0]
