# SPDX-License-Identifier: Apache-2.0
"""The demo of a target with CAN output: frames stand beside the commands."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import pytest
from rich.console import Console

from safety_island.cli.demo.events import DemoState
from safety_island.cli.demo.judge import conditions
from safety_island.cli.demo.text import can_command, can_number, plain_line
from safety_island.cli.demo.view import View
from safety_island.sim.courses import load_course
from tests.cli.demo.samples import ISLAND_SUMMARY, STATUS, TICK, VEHICLE_SUMMARY

CAN: dict[str, Any] = {
    "sequence": 42,
    "steering_tire_angle": {"value": 0.1, "unit": "rad", "defined": True},
    "acceleration": {"value": 0.5, "unit": "m/s^2", "defined": True},
}
DRIVING = DemoState(tick=TICK | {"can": CAN}, vehicle=STATUS)


def test_plain_line_shows_command_and_frames() -> None:
    line = plain_line(DRIVING)
    assert line.endswith("command +0.100 rad, +0.50 m/s²  CAN #42 +0.100000 rad, +0.500 m/s²")


def test_view_shows_command_and_frames() -> None:
    console = Console(width=90, record=True, file=None, quiet=False, force_terminal=False)
    with console.capture() as shown:
        console.print(View(load_course("s-curve"), "demo").draw(DRIVING))
    text = shown.get()
    assert "+0.100 rad, +0.50 m/s²" in text
    (row,) = [line for line in text.splitlines() if "CAN frames" in line]
    assert "+0.100000 rad, +0.500 m/s²" in row
    assert "#42" in row


@pytest.mark.parametrize("can", [None, {}, {"frames": [], "fault": "wrong_frames"}])
def test_a_tick_without_a_command_on_can(can: dict[str, Any] | None) -> None:
    state = DemoState(tick=TICK | {"can": can}, vehicle=STATUS)
    assert can_command(state) == ("wrong_frames" if can else "")
    assert can_number(state) == ""


@pytest.mark.parametrize(
    ("can", "holds"),
    [
        ({"sent": 390, "failed": 0, "rejected": 0}, True),
        ({"sent": 389, "failed": 1, "rejected": 0}, False),
        ({"sent": 389, "failed": 0, "rejected": 1}, False),
        ({"sent": 0, "failed": 0, "rejected": 0}, False),
    ],
)
def test_frames_are_judged(can: dict[str, int], holds: bool) -> None:
    state = DemoState(
        vehicle_summary=VEHICLE_SUMMARY, island_summary=ISLAND_SUMMARY | {"can_counts": can}
    )
    last = conditions(state)[-1]
    assert (last.name, last.holds) == ("can_frames", holds)
    assert f"{can['sent']} commands" in last.text


@pytest.mark.live
@pytest.mark.timeout(300)
def test_demo_of_the_simulator_target() -> None:
    command = [sys.executable, "-m", "safety_island", "demo", "--target", "freertos_posix"]
    done = subprocess.run(
        [*command, "--duration", "8", "--json"], capture_output=True, text=True, timeout=280
    )
    summary = json.loads(done.stdout)
    assert summary["conditions"]["can_frames"], done.stderr
    can = summary["island"]["can_counts"]
    assert can["output_mode"] == "DDS_AND_CAN"
    assert can["sent"] == summary["island"]["published"] > 0
    (line, *_) = [line for line in done.stderr.splitlines() if "  CAN #" in line]
    shown, frames = line.partition("  command ")[2].split("  CAN #")
    angle, carried = (float(text.split(" rad")[0].split()[-1]) for text in (shown, frames))
    assert abs(angle - carried) <= 0.0006  # the command is shown in milliradians
