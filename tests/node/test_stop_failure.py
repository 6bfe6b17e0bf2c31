# SPDX-License-Identifier: Apache-2.0
"""Every tick fails while a vehicle that hears CAN alone is braked."""

from __future__ import annotations

import pytest

from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.node.report import Outcome
from tests.faults.hands import fail_with
from tests.node.rig import FakeFollower, Rig
from tests.node.test_controller_output import RecordingOutput
from tests.node.test_life_cycle import can_only, motion, states, tick


@pytest.fixture
def stopping(
    follower: FakeFollower, monkeypatch: pytest.MonkeyPatch
) -> tuple[Rig, RecordingOutput]:
    """In the first tick of the ramp nothing failed."""
    rig, can = can_only(follower)
    for _ in range(5):
        tick(rig, stale=True)
    assert rig.node.life_cycle.state is State.STOP
    del can.sent[:]
    monkeypatch.setattr(rig.node.inputs, "take", fail_with(ZeroDivisionError("take")))
    return rig, can


def test_the_stop_goes_on(stopping: tuple[Rig, RecordingOutput]) -> None:
    rig, can = stopping
    report = tick(rig)
    assert (report.outcome, report.life.state) == (Outcome.FAULT, State.STOP)
    assert report.command is not None
    assert [motion(command) for command, _ in can.sent] == [(0.0625, 0.83125, -0.75)]


def test_what_cannot_be_judged_is_not_sent(
    stopping: tuple[Rig, RecordingOutput], monkeypatch: pytest.MonkeyPatch
) -> None:
    rig, can = stopping
    monkeypatch.setattr(rig.node.check, "check", fail_with(ZeroDivisionError("check")))
    reports = [tick(rig) for _ in range(30)]
    assert reports[0].life.state is State.STOP
    assert reports[-1].life == (State.SILENT, Reason.CONTROLLER_FAULT, Reason.INPUT_STALE)
    assert can.sent == []
    assert any("the stop failed: ZeroDivisionError: check" in line for line in rig.lines)
    assert states(rig)[-1].startswith("SILENT: the controllers failed")


def test_without_memory_the_process_ends(
    stopping: tuple[Rig, RecordingOutput], monkeypatch: pytest.MonkeyPatch
) -> None:
    rig, _ = stopping
    monkeypatch.setattr(rig.node.check, "check", fail_with(MemoryError()))
    with pytest.raises(MemoryError):
        tick(rig)
