# SPDX-License-Identifier: Apache-2.0
"""The main compute dies or stands still: rows 2, 52 and 74 of the catalogue of faults, live."""

from __future__ import annotations

import signal
import time

import pytest

from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.status_fields import Status
from tests.live.scene import VEHICLE, Scene

pytestmark = pytest.mark.live
LOST = (Reason.INPUT_STALE, Reason.PARTITION)
BOUND_S = 0.73
"""Age limit of the fast inputs, one period of 150 ms, and 80 ms for what lies between."""
STANDSTILL_S = 2.0


def test_silence_after_a_killed_main_compute(drive: Scene) -> None:
    drive.kill(VEHICLE)
    status = drive.state(State.SILENT, *LOST).message
    assert status.latched_cause in LOST
    _assert_silence_came_in_time(drive)
    drive.start(VEHICLE)
    _is_driven_again(drive)


def test_silence_while_the_main_compute_stands_still(drive: Scene) -> None:
    drive.signal(VEHICLE, signal.SIGSTOP)
    stopped_at = time.monotonic()
    drive.state(State.SILENT, *LOST)
    _assert_silence_came_in_time(drive)
    over = drive.status(lambda _: time.monotonic() - stopped_at >= STANDSTILL_S, "it stood still")
    assert over.message.state == State.SILENT
    drive.signal(VEHICLE, signal.SIGCONT)
    _is_driven_again(drive)


def _is_driven_again(drive: Scene) -> None:
    """Mode STOP, commands, AUTONOMOUS: what came while it stood still engages nothing."""
    ready = drive.state(State.READY, Reason.NOT_AUTONOMOUS).message
    assert ready.operation_mode == Mode.STOP
    drive.state(State.ACTIVE)
    drive.moves()


def _assert_silence_came_in_time(drive: Scene) -> None:
    """From the last odometry that the bridge sent to the last command that came of it.

    Both are of this machine's wall clock. A busy machine wakes the island late: what the island
    itself says of that is allowed for, and is nothing on an idle one.
    """
    statuses: list[Status] = [one.message for one in drive.island.heard[topics.STATUS]]
    armed = [status for status in statuses if status.state == State.ACTIVE and status.published]
    fast = [item for status in armed for item in status.inputs[1:4]]
    assert fast
    assert all(item.age <= item.age_limit for item in fast)
    last_input_ns = drive.island.heard[topics.ODOMETRY][-1].sent_ns
    last_command = drive.island.heard[topics.CONTROL][-1].message
    late_s = max(status.lateness + status.tick_time for status in statuses[-10:])
    silence_s = (last_command.stamp.nanoseconds - last_input_ns) / 1e9
    assert silence_s <= BOUND_S + late_s
