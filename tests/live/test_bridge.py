# SPDX-License-Identifier: Apache-2.0
"""The bridge dies and comes back: row 75 of the catalogue of faults, live."""

from __future__ import annotations

import signal
import time

import pytest

from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.live.ear import sent_since
from tests.live.scene import BRIDGE, Scene

pytestmark = pytest.mark.live
LOST = (Reason.INPUT_STALE, Reason.PARTITION)


def test_a_bridge_that_comes_back_is_driven_over_again(drive: Scene) -> None:
    drive.kill(BRIDGE)
    _is_silent_until_autonomous_mode_is_left(drive)
    _comes_back(drive)


def test_a_bridge_that_is_stopped_in_order_ends_the_drive_as_well(drive: Scene) -> None:
    drive.stop(BRIDGE)
    ready = drive.state(State.READY, Reason.MODE_WRITER_GONE).message
    assert ready.latched_cause == Reason.MODE_WRITER_GONE
    _is_silent_until_autonomous_mode_is_left(drive)
    _comes_back(drive)


def test_a_bridge_that_is_back_before_its_lease_has_ended(drive: Scene) -> None:
    drive.kill(BRIDGE)
    _comes_back(drive)


def _is_silent_until_autonomous_mode_is_left(drive: Scene) -> None:
    silent = drive.state(State.SILENT).message
    assert silent.reason in LOST
    assert silent.latched_cause in LOST
    modes = drive.main.heard[topics.OPERATION_MODE]
    drive.until(lambda: modes[-1].message.mode == Mode.STOP, "autonomous mode is left")


def _comes_back(drive: Scene) -> None:
    restarted_ns = time.time_ns()
    drive.start(BRIDGE)
    drive.state(State.READY, Reason.NOT_AUTONOMOUS)
    drive.state(State.ACTIVE)
    drive.moves()
    stamps_ns = sent_since(drive.main.heard[topics.CONTROL], restarted_ns)
    assert min(stamps_ns) > restarted_ns


def test_a_bridge_that_stood_still_forwards_again(drive: Scene) -> None:
    """It stood for longer than its lease: everybody has left and come back meanwhile."""
    for _ in range(2):
        drive.signal(BRIDGE, signal.SIGSTOP)
        _is_silent_until_autonomous_mode_is_left(drive)
        time.sleep(2.0)
        stood_ns = time.time_ns()
        drive.signal(BRIDGE, signal.SIGCONT)
        drive.state(State.ACTIVE)
        drive.moves()
        assert min(sent_since(drive.main.heard[topics.CONTROL], stood_ns)) > stood_ns
    assert "lost" not in drive.log(BRIDGE)
