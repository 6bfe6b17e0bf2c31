# SPDX-License-Identifier: Apache-2.0
"""``island run`` with CAN: frames beside commands, logs, and what happens without a bus."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from decimal import ROUND_HALF_UP, Decimal
from pathlib import Path
from typing import Any

import pytest

from safety_island.can.log_reader import read_log
from safety_island.cli.main import main
from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.messages.outputs import Control, decode_control

ISLAND = (sys.executable, "-m", "safety_island")
SIMULATOR = ("-t", "freertos_posix")
LIMIT_S = 60.0
COMMANDS = 12

Frames = dict[int, bytes]


def events(*words: str) -> tuple[list[dict[str, Any]], str]:
    """Drive in virtual time for two seconds; return what it reported and what it logged."""
    command = [*ISLAND, "run", "--platform", "sim", "--duration", "2", "--json", *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()], done.stderr


def frames_of(path: Path) -> dict[int, Frames]:
    """The frames of a log by the stamp [us] of their command."""
    found: dict[int, Frames] = {}
    for entry in read_log(str(path)):
        assert entry.frame is not None
        frames = found.setdefault(round(entry.time_s * 1e6), {})
        frames[entry.frame.arbitration_id] = entry.frame.data
    return found


def scaled(value: float, scale: int) -> int:
    """Decimal arithmetic as the contract says it: half away from zero."""
    return int((Decimal(value) * scale).quantize(Decimal(1), ROUND_HALF_UP))


def assert_same(command: Control, frames: Frames) -> None:
    """The frames carry the values of the DDS message to the last scaled digit."""
    angle, rate = struct.unpack("<ii", frames[0x100])
    speed, acceleration = struct.unpack("<ii", frames[0x101])
    assert angle == scaled(command.steering_tire_angle, 1_000_000)
    assert rate == scaled(command.steering_tire_rotation_rate, 1_000_000)
    assert speed == scaled(command.velocity, 1_000)
    assert acceleration == scaled(command.acceleration, 1_000)
    assert struct.unpack("<I", frames[0x102][4:])[0] == command.stamp.nanoseconds // 10**6 % 2**32


@contextmanager
def processes(*commands: list[str]) -> Iterator[None]:
    running = [subprocess.Popen(command, stdout=subprocess.DEVNULL) for command in commands]
    try:
        yield
    finally:
        for process in running:
            process.terminate()
        codes = [process.wait(30) for process in running]
    assert codes == [0] * len(running)


@pytest.mark.live
def test_frames_agree_with_control_on_dds(domain_id: int, tmp_path: Path) -> None:
    domain, log = ["--domain", str(domain_id)], tmp_path / "drive.log"
    run = [*ISLAND, "run", *domain, *SIMULATOR, "--period", "0.05", "--can-log", str(log)]
    with Participant(domain_id, DdsConfig(loopback_only=True), "listener") as participant:
        topic = topics.CONTROL
        heard = participant.subscription(topic.name, topic.type_name, topic.subscription_qos)
        commands: list[Control] = []
        with processes(run, [*ISLAND, "main-compute", *domain]):
            end = time.monotonic() + LIMIT_S
            while not any(item.velocity > 0.1 for item in commands[COMMANDS:]):
                assert time.monotonic() < end, f"{len(commands)} commands came"
                participant.wait(0.5)
                commands += [decode_control(sample.data) for sample in heard.take_all()]
    frames = frames_of(log)
    for command in commands:
        assert_same(command, frames[command.stamp.nanoseconds // 1000])


def test_ticks_show_the_frames_decoded(tmp_path: Path) -> None:
    log = tmp_path / "drive.log"
    found, said = events(*SIMULATOR, "--can-log", str(log))
    sent = [event for event in found if event["event"] == "tick" and event["can"]]
    assert [event["can"]["sequence"] for event in sent] == list(range(len(sent)))
    assert len(sent) >= COMMANDS
    for event in sent:
        can = event["can"]
        assert can["mode"] == "DDS_AND_CAN"
        for name in ("steering_tire_angle", "steering_tire_rotation_rate"):
            assert can[name]["value"] == pytest.approx(event[name], abs=1.1e-6)
        for name in ("velocity", "acceleration"):
            assert can[name]["value"] == pytest.approx(event[name], abs=0.51e-3)
    (summary,) = [event for event in found if event["event"] == "summary"]
    counts = summary["can_counts"]
    assert (counts["output_mode"], counts["sent"]) == ("DDS_AND_CAN", len(sent))
    assert len(frames_of(log)) == len(sent)
    assert "output mode DDS_AND_CAN on mock" in said


def test_without_json_frames_are_logged_now_and_then() -> None:
    command = [*ISLAND, "run", "--platform", "sim", "--duration", "4", *SIMULATOR]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    shown = [line for line in done.stderr.splitlines() if "] CAN " in line]
    assert len(shown) == 2  # at once, and three seconds later
    assert "steering_tire_angle" in shown[0]
    assert "DDS_AND_CAN stamp" in shown[0]


def test_dds_alone_reports_nothing_of_can() -> None:
    found, _ = events()
    assert not any("can" in event for event in found if event["event"] == "tick")
    assert next(event for event in found if event["event"] == "summary")["can_counts"] is None


def test_can_only_publishes_no_command() -> None:
    found, _ = events("--mode", "CAN_ONLY", "--can", "mock")
    ticks = [event for event in found if event["event"] == "tick" and event["can"]]
    assert {event["can"]["mode"] for event in ticks} == {"CAN_ONLY"}
    assert next(event for event in found if event["event"] == "vehicle")["commands"] == 0


NO_BUS = "slcan:/nowhere/tty"


def test_can_only_without_a_bus_ends_the_start(
    capsys: pytest.CaptureFixture[str], domain_id: int
) -> None:
    assert main(["run", "--domain", str(domain_id), "--mode", "CAN_ONLY", "--can", NO_BUS]) == 1
    (error,) = [line for line in capsys.readouterr().err.splitlines() if "island: error" in line]
    assert NO_BUS in error
    assert "CAN_ONLY needs it" in error


def test_can_only_without_a_name_ends_the_start(
    capsys: pytest.CaptureFixture[str], domain_id: int
) -> None:
    assert main(["run", "--domain", str(domain_id), "--mode", "CAN_ONLY"]) == 2
    assert "CAN_ONLY has no CAN bus: name one" in capsys.readouterr().err


@pytest.mark.live
def test_dds_and_can_without_a_bus_goes_on_over_dds_and_says_so(domain_id: int) -> None:
    command = [*ISLAND, "run", "--domain", str(domain_id), "--duration", "0.5", "--can", NO_BUS]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0
    assert "commands go out over DDS alone" in done.stderr
    assert "safety_island is live" in done.stderr


def test_log_that_cannot_be_written(capsys: pytest.CaptureFixture[str], domain_id: int) -> None:
    words = ["run", "--domain", str(domain_id), "--can", "mock", "--can-log", "/nowhere/x.log"]
    assert main(words) == 2
    assert "--can-log /nowhere/x.log: cannot be written" in capsys.readouterr().err
