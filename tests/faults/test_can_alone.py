# SPDX-License-Identifier: Apache-2.0
"""Rows 91 and 94: the end of an island that CAN alone hears, and a second master of the bus."""

from __future__ import annotations

from random import Random

import pytest

from safety_island.can.bus import BusEvent, EventKind
from safety_island.command.frames import WATCHED_IDS
from safety_island.control.status import Mode
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.faults import wire
from tests.faults.checks import BOTH, stays_active
from tests.faults.scene import SLOW, Row, Scene

LONGEST_STOP_S = 10.0
"""At 5 m/s: hold, ramp and the time for which the stopped vehicle is held."""


def end(scene: Scene, after_s: float) -> list[Row]:
    """Run on the timer, told to end after a time [s]; return the ticks."""
    begin = len(scene.rows)
    at_ns = scene.clock.monotonic_ns() + round(after_s * 1e9)
    scene.clock.call_at(at_ns, scene.node.stop)
    scene.node.run(scene.period_s, 60.0)
    return scene.rows[begin:]


@BOTH
def test_row_91_with_can_alone_the_declared_stop_comes_before_the_end(
    period_s: float, random: Random
) -> None:
    for _ in range(3):
        scene = Scene(period_s, has_ramp=True).drive()
        began, phase_s = scene.now, random.uniform(0.0, 1.0)
        rows = end(scene, phase_s)
        outputs = list(dict.fromkeys(row.output for row in rows))
        assert outputs[-3:] == ["held", "ramp", "silent"]
        assert outputs[:-3] in ([], ["published"])
        assert [row.output for row in rows].count("held") == 2
        assert rows[-1].at - began - phase_s < LONGEST_STOP_S
        assert abs(rows[-1].speed) < 0.1, "the vehicle stands"
        assert {row.reason for row in rows if row.output != "published"} == {Reason.SHUTTING_DOWN}


def test_row_91_the_planned_end_of_a_drive_is_no_other() -> None:
    scene = Scene(SLOW, has_ramp=True).drive()
    scene.node.run(scene.period_s, 1.0)
    assert scene.rows[-1].state is State.SILENT
    assert abs(scene.rows[-1].speed) < 0.1


def test_row_91_where_a_gate_brakes_the_end_comes_at_once() -> None:
    scene = Scene(SLOW).drive()
    began = scene.now
    rows = end(scene, 0.5)
    assert {row.output for row in rows} == {"published"}
    assert scene.now - began <= 0.5 + SLOW


def foreign(scene: Scene, arbitration_id: int = 0x100) -> None:
    """Let another node send one of our frames."""
    scene.bus.tell(BusEvent(EventKind.FOREIGN_COMMAND, arbitration_id))


@BOTH
@pytest.mark.parametrize("has_ramp", [False, True])
@pytest.mark.parametrize("arbitration_id", sorted(WATCHED_IDS))
def test_row_94_a_second_master_is_seen_while_the_island_waits(
    period_s: float, has_ramp: bool, arbitration_id: int
) -> None:
    scene = Scene(period_s, has_ramp=has_ramp, absent=["odometry"])
    assert scene.tick().reason is Reason.WAITING_FOR_INPUT
    foreign(scene, arbitration_id)
    row = scene.tick()
    assert (row.state, row.reason) == (State.INIT, Reason.SECOND_CAN_MASTER)
    assert scene.node.sender.foreign_frames == 1
    assert f"another node sends our CAN frame 0x{arbitration_id:03X}" in scene.log_text


@BOTH
@pytest.mark.parametrize("has_ramp", [False, True])
def test_row_94_a_second_master_is_seen_while_silent_and_keeps_it_so(
    period_s: float, has_ramp: bool
) -> None:
    scene = Scene(period_s, has_ramp=has_ramp).drive()
    scene.inject(wire.drop, "odometry")
    scene.run(LONGEST_STOP_S)
    assert scene.rows[-1].state is State.SILENT
    scene.clear()
    scene.run(1.0)
    foreign(scene)
    row = scene.tick()
    assert (row.state, row.reason) == (State.SILENT, Reason.SECOND_CAN_MASTER)
    scene.disengage()
    for _ in range(round(3.0 / period_s)):
        foreign(scene)
        row = scene.tick()
        assert row.output == "silent"
        assert row.reason is Reason.SECOND_CAN_MASTER
    assert scene.log_text.count("another node sends our CAN frame 0x100") == 1


@BOTH
@pytest.mark.parametrize("has_ramp", [False, True])
def test_row_94_it_does_not_arm_beside_one_and_does_when_it_has_gone(
    period_s: float, has_ramp: bool
) -> None:
    scene = Scene(period_s, has_ramp=has_ramp, start_speed=0.0)
    scene.world.mode, scene.world.gate.engaged = Mode.STOP, False
    for _ in range(round(2.0 / period_s)):
        foreign(scene)
        row = scene.tick()
        assert row.output == "silent" and row.state is State.INIT
    rows = scene.run(3.0)
    assert rows[-1].state is State.ACTIVE
    assert scene.node.sender.foreign_frames == 0
    assert "no other node sends our CAN frames any more" in scene.log_text


@pytest.mark.parametrize("has_ramp", [False, True])
def test_row_94_who_drives_drives_on_and_raises_the_alarm(has_ramp: bool) -> None:
    scene = Scene(SLOW, has_ramp=has_ramp).drive()
    foreign(scene)
    stays_active(scene, 0.5)
    assert scene.node.sender.foreign_frames == 1
    stays_active(scene, 2.0)
    assert scene.node.sender.foreign_frames == 0


def test_row_94_a_flood_of_foreign_frames_makes_two_lines_at_most_in_3_s() -> None:
    scene = Scene(SLOW, absent=["odometry"])
    for number in range(200):
        for _ in range(256 if number % 20 < 10 else 0):  # there, and gone again
            foreign(scene)
        scene.tick()
    assert scene.log_text.count("another node sends our CAN frame") <= 2 + 30 / 3
