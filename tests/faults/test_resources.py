# SPDX-License-Identifier: Apache-2.0
"""Rows 47 to 50 of the fault catalogue: garbage, memory, descriptors."""

from __future__ import annotations

import gc
import sys
import tracemalloc
from typing import Any

import pytest

from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.node.report import Outcome
from tests.faults.checks import rearms, stays_active, stays_latched
from tests.faults.hands import fail_with, run
from tests.faults.scene import FAST, SLOW, Scene


def test_row_47_no_collection_happens_in_a_tick() -> None:
    """What exists is frozen, new garbage waits for the time between two ticks."""
    scene = Scene().drive()
    collected: list[str] = []
    in_tick = [False]
    tick = scene.node.tick

    def watched(*arguments: Any, **named: Any) -> Any:
        in_tick[0] = True
        assert not gc.isenabled() and gc.get_freeze_count() > 10_000
        for _ in range(2000):
            cycle: list[Any] = []
            cycle.append(cycle)
        report = tick(*arguments, **named)
        in_tick[0] = False
        return report

    def note(phase: str, info: dict[str, int]) -> None:
        collected.append(f"{phase} {info['generation']} {in_tick[0]}")

    scene.node.tick = watched  # type: ignore[method-assign]
    gc.callbacks.append(note)
    try:
        run(scene, 140 * SLOW)
    finally:
        gc.callbacks.remove(note)
    assert not [line for line in collected if line.endswith("True")]
    assert any(line.startswith("start 1") for line in collected)


def test_row_48_memory_does_not_grow() -> None:
    """Less than 1 MB an hour is the promise; a drive of minutes leaves no trace at all."""
    scene = Scene().drive()
    scene.run(60.0)
    lasting(scene, 240.0)  # until what is kept, within bounds, is full
    blocks = sys.getallocatedblocks()
    tracemalloc.start()
    try:
        lasting(scene, 50.0)
        before = tracemalloc.get_traced_memory()[0]
        lasting(scene, 150.0)
        growth = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
    assert growth < 20_000
    assert sys.getallocatedblocks() - blocks < 2000


def lasting(scene: Scene, seconds: float) -> None:
    """Drive on without keeping the log of the scene."""
    for _ in range(round(seconds / 10.0)):
        scene.run(10.0)
        scene.rows.clear()
        scene.platform.logger.lines.clear()


@pytest.mark.parametrize("place", ["_tell", "warn"])
def test_row_49_nor_is_it_swallowed_after_the_command(
    place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = Scene().drive()
    where: Any = scene.node.status if place == "_tell" else scene.node.inputs
    monkeypatch.setattr(where, place, fail_with(MemoryError()))
    with pytest.raises(MemoryError):
        scene.run(1.0)


@pytest.mark.parametrize("place", ["run_lateral", "run_longitudinal", "sync", "_offer"])
def test_row_49_without_memory_the_process_ends(
    place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No command of that tick, and an exception that no handler swallows."""
    scene = Scene().drive()
    ticks = len(scene.rows)
    where = scene.input("odometry") if place == "_offer" else scene.follower
    monkeypatch.setattr(where, place, fail_with(MemoryError()))
    with pytest.raises(MemoryError):
        run(scene, 1.0)
    assert len(scene.rows) == ticks
    assert not scene._heard.take_all() and not scene.bus.frames
    assert gc.isenabled()


def test_row_50_an_output_without_descriptors_stops_no_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """DDS_AND_CAN: the topic fails, the frames go on."""
    scene = Scene().drive()
    topic: Any = scene.node.sender.outputs[0]
    monkeypatch.setattr(topic._publisher, "write", fail_with(OSError(24, "Too many open files")))
    rows = scene.run(3.0)
    assert {(row.state, row.output) for row in rows} == {(State.ACTIVE, "published")}
    assert topic.failed >= len(rows)
    assert "Too many open files" in scene.log_text


@pytest.mark.parametrize("period_s", [SLOW, FAST])
def test_row_50_without_any_output_it_is_silent(
    monkeypatch: pytest.MonkeyPatch, period_s: float
) -> None:
    scene = Scene(period_s).drive()
    with monkeypatch.context() as patch:
        for output in scene.node.sender.outputs:
            patch.setattr(output, "send", fail_with(OSError(24, "Too many open files")))
        rows = scene.run(5 * period_s)
        ticks = scene.parameters.life_cycle.fault_ticks
        assert {row.output for row in rows} == {"silent"}
        assert rows[0].outcome is Outcome.OUTPUT_FAILED
        assert [row.state for row in rows].index(State.SILENT) <= ticks
    stays_latched(scene, Reason.OUTPUT_FAILED)
    rearms(scene)


def test_row_50_a_debug_topic_is_not_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene().drive()
    for writer in scene.node._times.writers:
        monkeypatch.setattr(writer._publisher, "write", fail_with(OSError(24, "no more")))
    stays_active(scene, 2.0)
