# SPDX-License-Identifier: Apache-2.0
"""What the monitor prints."""

from __future__ import annotations

import json

from safety_island.can.candump import LogEntry
from safety_island.can.encoder import Rejection, encode
from safety_island.can.monitor import BusMonitor
from safety_island.can.report import command_text, command_values, summary_lines, summary_values
from safety_island.command.mode import OutputMode
from tests.can.rig import REFERENCE, triple


def heard(*sequences: int) -> BusMonitor:
    monitor = BusMonitor(0.15)
    for index, sequence in enumerate(sequences):
        for frame in triple(sequence):
            monitor.feed(LogEntry(12.345 + 0.15 * index, frame))
    return monitor


def test_a_command_in_one_line_with_units() -> None:
    seen = heard(42).latest
    assert seen is not None
    assert command_text(seen) == (
        "12.345000  #42  steering_tire_angle 0.125000 rad  "
        "steering_tire_rotation_rate -0.500000 rad/s  velocity 12.250 m/s  "
        "acceleration -1.500 m/s^2  DDS_AND_CAN stamp 12345 ms"
    )


def test_an_undefined_value_says_so() -> None:
    command = REFERENCE._replace(
        is_defined_steering_tire_rotation_rate=False, is_defined_acceleration=False
    )
    frames = encode(command, OutputMode.CAN_ONLY, 1, 0)
    assert not isinstance(frames, Rejection)
    monitor = BusMonitor(0.15)
    seen = [monitor.feed(LogEntry(0.0, frame)) for frame in frames][-1]
    assert seen is not None
    assert "steering_tire_rotation_rate undefined" in command_text(seen)
    assert "acceleration undefined" in command_text(seen)
    values = command_values(seen)
    assert values["acceleration"] == {"value": -1.5, "unit": "m/s^2", "defined": False}
    assert values["velocity"] == {"value": 12.25, "unit": "m/s", "defined": True}


def test_summary_as_plain_values() -> None:
    monitor = heard(42, 43, 45)
    found = json.loads(json.dumps(summary_values(monitor, 13.0)))
    assert found["frames"]["0x100"]["name"] == "LATERAL_COMMAND"
    assert found["frames"]["0x100"]["count"] == 3
    assert round(found["commands"]["rate_hz"], 3) == 6.667
    assert round(found["commands"]["age_s"], 3) == 0.355
    assert found["sequence"] == {"gaps": 1, "missing": 1, "repeated": 0, "backward": 0}
    assert found["latest"]["sequence"] == 45
    assert found["latest"]["lag_ms"] == 300
    assert found["latest"]["steering_tire_angle"]["unit"] == "rad"
    assert found["incomplete"] == {}


def test_summary_as_text() -> None:
    monitor = heard(42, 43, 45)
    monitor.feed(LogEntry(14.0, triple()[0]))
    monitor.feed(LogEntry(14.0, triple()[2]))
    text = "\n".join(summary_lines(monitor, 14.0))
    assert "0x102 COMMAND_STATUS" in text
    assert "6.67 Hz" in text
    assert "sequence: 1 gaps, 1 commands missing, 0 repeated, 0 backward; 1 losses" in text
    assert "not complete: 1 torn" in text


def test_summary_of_nothing() -> None:
    found = summary_values(BusMonitor(0.15), 1.0)
    assert found["latest"] is None
    assert found["commands"]["rate_hz"] is None
    assert "- Hz" in summary_lines(BusMonitor(0.15), 1.0)[0]


def test_a_loss_that_goes_on_is_never_no_loss() -> None:
    monitor = heard(42, 43, 44)
    text = "\n".join(summary_lines(monitor, 12.645 + 8.0))
    assert "0 losses" not in text
    assert text.endswith("LOST: no new command for 8.000 s, and none of its frames comes")
    found = summary_values(monitor, 12.645 + 8.0)
    assert (found["commands"]["losses"], found["commands"]["link"]) == (1, "lost")
    assert found["alarm"].startswith("LOST: no new command for 8.000 s")
    assert summary_values(monitor, 12.7)["alarm"] is None
