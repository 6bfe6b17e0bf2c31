# SPDX-License-Identifier: Apache-2.0
"""Row 51 of the fault catalogue: an exception in each part of the island."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.faults.checks import rearms, stays_active, stays_latched
from tests.faults.hands import fail_with
from tests.faults.scene import Scene

PLACES: dict[str, Callable[[Scene], tuple[Any, str]]] = {
    "identity": lambda scene: (scene.node.identity, "look"),
    "identity.blocked": lambda scene: (scene.node.identity, "blocked"),
    "inputs.take": lambda scene: (scene.node.inputs, "take"),
    "inputs.blocked": lambda scene: (scene.node.inputs, "blocked"),
    "inputs.disengaged": lambda scene: (scene.node.inputs, "_disengaged"),
    "follower.allow_control": lambda scene: (scene.follower, "allow_control"),
    "follower.is_ready": lambda scene: (scene.follower, "is_ready"),
    "follower.run_lateral": lambda scene: (scene.follower, "run_lateral"),
    "follower.run_longitudinal": lambda scene: (scene.follower, "run_longitudinal"),
    "follower.sync": lambda scene: (scene.follower, "sync"),
    "check": lambda scene: (scene.node._path, "check"),
    "life_cycle.judge": lambda scene: (scene.node.life_cycle, "judge"),
    "life_cycle.begin": lambda scene: (scene.node.life_cycle, "begin"),
    "arming": lambda scene: (scene.node.arming, "take"),
    "processing time": lambda scene: (scene.node._times, "send"),
    "send": lambda scene: (scene.node._path, "send"),
}


@pytest.mark.parametrize("place", PLACES)
def test_row_51_an_exception_costs_its_tick_and_many_end_the_output(
    place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = Scene().drive()
    where, name = PLACES[place](scene)
    with monkeypatch.context() as patch:
        patch.setattr(where, name, fail_with(ZeroDivisionError("on purpose")))
        row = scene.tick()
        assert (row.output, row.state) == ("silent", State.ACTIVE)
    assert "on purpose" in scene.log_text
    stays_active(scene, 1.0)
    with monkeypatch.context() as patch:
        patch.setattr(where, name, fail_with(ZeroDivisionError("on purpose")))
        rows = [scene.tick() for _ in range(5)]
        assert {row.output for row in rows} == {"silent"}
        ticks = scene.parameters.life_cycle.fault_ticks
        assert [row.state for row in rows].index(State.SILENT) < ticks
        assert rows[-1].reason is Reason.CONTROLLER_FAULT
    stays_latched(scene, Reason.CONTROLLER_FAULT)
    rearms(scene)


@pytest.mark.parametrize("place", PLACES)
def test_row_51_can_only_stops_the_vehicle_though_every_tick_fails(
    place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = Scene(has_ramp=True).drive()
    ticks = scene.parameters.life_cycle.fault_ticks
    monkeypatch.setattr(*PLACES[place](scene), fail_with(ZeroDivisionError("on purpose")))
    outputs = [row.output for row in scene.run(9.0)][ticks - 1 :]
    assert outputs == sorted(outputs, key=("held", "ramp", "silent").index)
    assert set(outputs) == {"held", "ramp", "silent"}
    assert scene.rows[-1].speed == 0.0
    assert scene.rows[-1].reason is Reason.CONTROLLER_FAULT


@pytest.mark.parametrize("name", ["_decode", "_check", "_offer"])
@pytest.mark.parametrize("key", ["trajectory", "odometry", "steering", "acceleration"])
def test_row_51_an_exception_over_a_sample_refuses_that_sample(key: str, name: str) -> None:
    """The input ages out, the others and the tick go on."""
    scene = Scene().drive()
    item = scene.input(key)
    kept = getattr(item, name)
    setattr(item, name, fail_with(ZeroDivisionError("on purpose")))
    stays_active(scene, 0.15)
    rows = scene.run(1.5)
    assert rows[-1].reason is Reason.INPUT_STALE
    assert rows[-1].output == "silent"
    setattr(item, name, kept)
    scene.run(0.6)
    stays_latched(scene, Reason.INPUT_STALE)
    rearms(scene)


ASIDE: dict[str, Callable[[Scene], tuple[Any, str]]] = {
    "warnings": lambda scene: (scene.node.inputs, "warn"),
    "rates": lambda scene: (scene.input("odometry").rate, "look"),
    "status": lambda scene: (scene.node.status, "_tell"),
}


@pytest.mark.parametrize("place", ASIDE)
def test_row_51_an_exception_in_what_only_tells_costs_no_command(
    place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = Scene().drive()
    monkeypatch.setattr(*ASIDE[place](scene), fail_with(ZeroDivisionError("on purpose")))
    stays_active(scene, 2.0)
    assert "on purpose" in scene.log_text


def test_row_51_silence_goes_on_though_nothing_can_be_taken_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = Scene().drive()
    monkeypatch.setattr(scene.node.sender, "withdraw", fail_with(ZeroDivisionError("on purpose")))
    monkeypatch.setattr(scene.node.inputs, "take", fail_with(ZeroDivisionError("on purpose")))
    rows = scene.run(2.0)
    assert (rows[-1].state, rows[-1].output) == (State.SILENT, "silent")
    assert "the end of a tick failed" in scene.log_text
