# SPDX-License-Identifier: Apache-2.0
"""How a driving island ends, and what does not end it: row 91 of the catalogue of faults, live."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from safety_island.can.log_reader import read_log
from safety_island.can.monitor import BusMonitor, Seen
from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.live.driver import Driver
from tests.live.scene import ISLAND, LONGEST, Scene

pytestmark = pytest.mark.live

ALONE = ("--mode", "CAN_ONLY", "--can", "mock")
STOP_LIMIT_S = 30.0
"""The ramp from 1 m/s takes some 4 s; the rest is for a busy machine."""
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


class Driving(NamedTuple):
    """An island that is ACTIVE at 1 m/s, with pipes for what it says."""

    scene: Scene
    driver: Driver
    process: subprocess.Popen[bytes]
    log: Path

    def send(self, number: signal.Signals) -> None:
        self.process.send_signal(number)

    def ends(self) -> int:
        """Wait until the process has ended, the inputs going on; return its exit code."""
        self.scene.until(lambda: self.process.poll() is not None, "the island ends")
        return self.process.returncode

    def commands(self) -> list[Seen]:
        """What left on CAN."""
        monitor = BusMonitor(0.15)
        return [seen for entry in read_log(str(self.log)) if (seen := monitor.feed(entry))]


def drive(scene: Scene, words: tuple[str, ...], tmp_path: Path) -> Driving:
    log = tmp_path / "can.log"
    command = [sys.executable, "-m", "safety_island", "run", *LONGEST, "--json", "--interface"]
    command += ["lo", "--domain", str(scene.domains[1]), *words, "--can-log", str(log)]
    environment = {key: value for key, value in os.environ.items() if key != "CYCLONEDDS_URI"}
    pipe = subprocess.PIPE
    process = subprocess.Popen(command, stdout=pipe, stderr=pipe, env=environment)
    scene._running[ISLAND] = process
    driver = Driver(scene.domains[1], Mode.STOP)
    scene.meanwhile = driver.send
    scene.state(State.READY)
    driver.tell(Mode.AUTONOMOUS)
    scene.state(State.ACTIVE)
    return Driving(scene, driver, process, log)


@pytest.fixture
def alone(scene: Scene, tmp_path: Path) -> Iterator[Driving]:
    """With CAN alone."""
    yield from _closed(drive(scene, ALONE, tmp_path))


@pytest.fixture(params=[ALONE, ("--can", "mock")], ids=["CAN_ONLY", "DDS_AND_CAN"])
def driving(scene: Scene, tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Driving]:
    """With CAN alone, and with DDS."""
    yield from _closed(drive(scene, request.param, tmp_path))


def _closed(driving: Driving) -> Iterator[Driving]:
    yield driving
    driving.driver.close()
    for stream in (driving.process.stdout, driving.process.stderr):
        assert stream is not None
        stream.close()


def went_on(driving: Driving, ticks: int = 20) -> None:
    """Wait for some more ticks; nothing ends (a busy machine may be late with inputs)."""
    scene = driving.scene
    first = scene.state(State.ACTIVE).message.tick
    reasons = set()

    def enough() -> bool:
        found = scene.island.heard[topics.STATUS][-1].message
        reasons.add(found.reason)
        return bool(found.tick >= first + ticks)

    scene.until(enough, "it drives on")
    assert Reason.SHUTTING_DOWN not in reasons
    assert driving.process.poll() is None


@pytest.mark.parametrize("number", SIGNALS)
def test_with_can_alone_the_vehicle_is_stopped_first(
    alone: Driving, number: signal.Signals
) -> None:
    alone.send(number)
    alone.scene.state(State.STOP, Reason.SHUTTING_DOWN)
    assert alone.ends() == 0
    speeds = [seen.decoded.command.velocity for seen in alone.commands()]
    assert speeds[-1] == 0.0
    last = speeds[speeds.index(max(speeds)) :]
    assert last == sorted(last, reverse=True)
    assert len(last) > 5


def test_a_second_signal_ends_it_at_once(alone: Driving) -> None:
    alone.send(signal.SIGTERM)
    alone.scene.state(State.STOP, Reason.SHUTTING_DOWN)
    alone.send(signal.SIGINT)
    assert alone.process.wait(STOP_LIMIT_S) == 0
    assert alone.commands()[-1].decoded.command.velocity > 0.0


def test_a_lost_reader_does_not_end_a_drive(driving: Driving) -> None:
    """``island run --json | head``."""
    assert driving.process.stdout is not None and driving.process.stderr is not None
    driving.process.stdout.close()
    went_on(driving)
    driving.send(signal.SIGTERM)
    assert driving.ends() == 0
    told = driving.process.stderr.read().decode()
    assert told.count("standard output is lost (broken pipe)") == 1


def test_nor_do_a_lost_log_and_the_terminal_with_both(driving: Driving) -> None:
    for stream in (driving.process.stdout, driving.process.stderr):
        assert stream is not None
        stream.close()
    went_on(driving)
    driving.send(signal.SIGHUP)
    assert driving.ends() == 0
