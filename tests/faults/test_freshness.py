# SPDX-License-Identifier: Apache-2.0
"""Rows 9 to 13 of the fault catalogue: what is frozen, dead, or comes in another order."""

from __future__ import annotations

import sys
import tracemalloc
from collections.abc import Sequence
from itertools import permutations

import pytest

from safety_island.control.status import Mode
from safety_island.input_gate.reason import SampleReason
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.faults import wire
from tests.faults.checks import (
    BOTH,
    bound,
    rearms,
    recovers,
    silent_within,
    stays_active,
    stays_latched,
    subject,
)
from tests.faults.scene import AGED, INPUTS, Scene

TICKS_OF_A_DEAD_PLANNER = 20_000
MOST_GROWTH = 8_000
"""Bytes that may come and go in 2000 ticks; a leak of one number a tick is more."""


@BOTH
def test_row_09_frozen_odometry_under_fresh_stamps_ends_the_output(period_s: float) -> None:
    scene = Scene(period_s).drive()
    since = scene.inject(wire.frozen_content(), "odometry")
    silent_within(scene, since, bound("odometry", period_s) + 0.025)  # the first one is real
    assert scene.refused("odometry", SampleReason.FROZEN) > 0
    assert subject(scene.rows[-1]) == "odometry"
    recovers(scene, Reason.INPUT_STALE)


def test_row_09_a_vehicle_at_rest_may_repeat_its_odometry() -> None:
    scene = Scene()
    scene.world._engage = False
    scene.run(4.0)
    assert scene.world.plant.speed == 0.0
    assert {row.state for row in scene.run(5.0)} == {State.READY}
    assert not scene.refused("odometry", SampleReason.FROZEN)


@BOTH
@pytest.mark.parametrize("key", AGED)
def test_row_10_a_frozen_stamp_is_no_sign_of_life(key: str, period_s: float) -> None:
    scene = Scene(period_s).drive()
    since = scene.inject(wire.frozen_stamp(), key)
    first = silent_within(scene, since, bound(key, period_s) + 0.1)  # the first one is real
    assert (first.reason, subject(first)) == (Reason.INPUT_STALE, key)
    still, same = SampleReason.STAMP_STANDS_STILL, SampleReason.DUPLICATE
    assert scene.refused(key, still) + scene.refused(key, same) > 0
    recovers(scene, Reason.INPUT_STALE)


@BOTH
def test_row_11_a_dead_planner_ends_the_output(period_s: float) -> None:
    scene = Scene(period_s).drive()
    scene.wires["trajectory"].stop()
    first = silent_within(scene, scene.now, 0.9 + period_s + 0.08)
    assert subject(first) == "trajectory"
    scene.wires["trajectory"].restart()
    recovers(scene, Reason.INPUT_STALE)


def test_row_11_with_a_dead_planner_memory_is_flat() -> None:
    """50 minutes at 150 ms; what is received, refused or waiting is counted, never kept."""
    scene = Scene().drive()
    scene.wires["trajectory"].stop()
    scene.run(30.0)
    scene.rows.clear()
    scene.node.observers.clear()
    _feed_for_ticks(scene, 5_000)  # until everything that is bounded is full
    blocks = sys.getallocatedblocks()
    _feed_for_ticks(scene, TICKS_OF_A_DEAD_PLANNER)
    assert sys.getallocatedblocks() - blocks < TICKS_OF_A_DEAD_PLANNER / 100
    tracemalloc.start()
    try:
        _feed_for_ticks(scene, 1_000)
        before = tracemalloc.get_traced_memory()[0]
        _feed_for_ticks(scene, 2_000)
        growth = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
    assert scene.node.life_cycle.state is State.SILENT
    assert growth < MOST_GROWTH


def _feed_for_ticks(scene: Scene, count: int) -> None:
    """Tick with every input but the trajectory, and without the rest of the world."""
    lines = scene.platform.logger.lines
    for number in range(count):
        if number % 1000 == 0:
            lines.clear()
            scene.bus.frames.clear()
            scene._heard.take_all()
        now = scene.node.clock.monotonic_ns() + number * 150_000_000
        for key in AGED[1:]:
            for fault in wire.stamped(now // 10**9, now % 10**9)(scene.wires[key].sent[0]):
                scene.wires[key].release([fault[1]])
        scene.node.tick(now / 1e9)
    scene.clock._now_ns += count * 150_000_000


def test_row_12_a_mode_that_stays_is_told_once() -> None:
    scene = Scene().drive()
    accepted = scene.input("operation_mode").accepted
    stays_active(scene, 60.0)
    assert scene.input("operation_mode").accepted == accepted


@BOTH
def test_row_12_without_a_writer_of_the_mode_nobody_says_that_we_drive(period_s: float) -> None:
    scene = Scene(period_s).drive()
    scene.wires["operation_mode"].stop()
    row = scene.tick()
    assert (row.state, row.reason) == (State.READY, Reason.MODE_WRITER_GONE)
    rows = scene.run(2.0)
    assert {row.state for row in rows} == {State.READY}
    scene.wires["operation_mode"].restart()
    assert scene.tick().state is not State.ACTIVE, "the new writer has said nothing yet"
    scene.main_compute._told_mode = None
    stays_active_soon(scene)


@BOTH
def test_row_12_can_only_stops_when_the_writer_of_the_mode_is_gone(period_s: float) -> None:
    """Nobody else brakes a vehicle that hears CAN alone."""
    scene = Scene(period_s, has_ramp=True).drive()
    scene.wires["operation_mode"].stop()
    row = scene.tick()
    assert (row.state, row.reason, row.output) == (State.HOLD, Reason.MODE_WRITER_GONE, "held")
    rows = [row, *scene.run(8.0)]
    outputs = [row.output for row in rows]
    assert outputs == sorted(outputs, key=("held", "ramp", "silent").index)
    stopped = next(row for row in rows if row.output == "silent")
    assert (stopped.speed, stopped.reason) == (0.0, Reason.MODE_WRITER_GONE)
    scene.wires["operation_mode"].restart()
    scene.main_compute._told_mode = None
    scene.run(0.6)
    stays_latched(scene, Reason.MODE_WRITER_GONE)
    rearms(scene)


def stays_active_soon(scene: Scene) -> None:
    """Let the main compute tell what it has to tell, then drive on."""
    scene.run(max(0.05, scene.period_s))
    stays_active(scene, 2.0)


ORDERS = {"-".join(key[:2] for key in order): order for order in permutations(INPUTS)}


@pytest.mark.parametrize("order", ORDERS.values(), ids=ORDERS)
def test_row_13_ready_needs_the_full_set_in_any_order(order: Sequence[str]) -> None:
    scene = Scene(absent=INPUTS)
    scene.world._engage = False
    scene.main_compute._told_mode = Mode.UNKNOWN
    for key in order:
        row = scene.tick()
        assert (row.state, row.output) == (State.INIT, "silent")
        assert row.reason is Reason.WAITING_FOR_INPUT
        scene.wires[key].restart()
        scene.main_compute._told_mode = None
        scene.main_compute.publish_vehicle()
        scene.main_compute.publish_plan()
    row = scene.tick()
    assert (row.state, row.output) == (State.READY, "published")
    scene.world._engage = True
    scene.run(0.6)
    stays_active(scene, 1.0)


def test_row_13_an_island_that_joins_late_hears_the_mode() -> None:
    """The operation mode is latched: who comes later is told; beside another it does not arm."""
    scene = Scene().drive()
    late = scene.new_node()
    for _ in range(2):
        scene.tick()
        report = late.tick()
    assert late.inputs.items[-1].accepted == 1
    assert (report.life.state, report.life.reason) == (State.INIT, Reason.SECOND_ISLAND)
    assert late.inputs.disengaged is Reason.NONE
