# SPDX-License-Identifier: Apache-2.0
"""What a publisher behind the bridge does counts as if it were on the island's own domain.

Rows 83 to 86 of the catalogue of faults, live, with the shipped bridge.
"""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest

from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.qos import Qos
from safety_island.dds.topics import TopicEntry
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.inputs import OperationMode, encode_operation_mode
from safety_island.messages.outputs import Control, encode_control
from safety_island.messages.wire import Time
from tests.live.driver import Driver
from tests.live.scene import BRIDGE, ISLAND, VEHICLE, Scene

pytestmark = pytest.mark.live
ROGUE_SPEED = 20.0
BEST_EFFORT = Qos(reliability="best_effort")
WEAK = [
    (topics.STEERING, BEST_EFFORT),
    (topics.OPERATION_MODE, BEST_EFFORT),
    (topics.OPERATION_MODE, Qos()),
]


class ModePublisher:
    """The operation mode, published by a process of its own."""

    def __init__(self, domain: int) -> None:
        command = [sys.executable, "-m", "tests.live.mode_publisher", str(domain)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, text=True)

    def tell(self, mode: Mode) -> None:
        """Publish a mode."""
        assert self.process.stdin is not None
        self.process.stdin.write(f"{int(mode)}\n")
        self.process.stdin.flush()

    def leave(self) -> None:
        """Leave in good order."""
        self.process.communicate(timeout=10.0)

    def kill(self) -> None:
        """End as a crash does."""
        self.process.kill()
        self.process.communicate()


@pytest.fixture
def mode(scene: Scene) -> Iterator[ModePublisher]:
    """Island and bridge; behind it all inputs, and the mode from another process; ACTIVE."""
    scene.start(ISLAND)
    scene.start(BRIDGE)
    inputs = [entry for entry in topics.INPUTS if entry is not topics.OPERATION_MODE]
    driver = Driver(scene.domains[0], entries=inputs)
    scene.meanwhile = driver.send
    publisher = ModePublisher(scene.domains[0])
    publisher.tell(Mode.STOP)
    scene.state(State.READY, Reason.NOT_AUTONOMOUS)
    publisher.tell(Mode.AUTONOMOUS)
    scene.state(State.ACTIVE)
    yield publisher
    publisher.kill()
    driver.close()


@pytest.mark.parametrize("how", ["leave", "kill"])
def test_row_84_the_publisher_of_the_mode_is_gone_behind_the_bridge(
    scene: Scene, mode: ModePublisher, how: str
) -> None:
    """The other inputs go on: nothing else would tell."""
    getattr(mode, how)()
    scene.state(State.READY, Reason.MODE_WRITER_GONE)
    back = ModePublisher(scene.domains[0])
    back.tell(Mode.STOP)
    scene.state(State.READY, Reason.NOT_AUTONOMOUS)
    back.tell(Mode.AUTONOMOUS)
    scene.state(State.ACTIVE)
    back.leave()


def test_row_84_a_silent_second_publisher_of_the_mode_does_not_keep_the_first_alive(
    scene: Scene, mode: ModePublisher
) -> None:
    entry = topics.OPERATION_MODE
    with Participant(scene.domains[0], DdsConfig(interface="lo"), "silent") as other:
        publisher = other.publisher(entry.name, entry.type_name, entry.qos)
        scene.until(lambda: publisher.matched() > 0, "the bridge listens to it")
        mode.leave()
        scene.state(State.READY, Reason.MODE_WRITER_GONE)


@pytest.mark.parametrize(("entry", "qos"), WEAK)
def test_row_83_a_publisher_of_weaker_qos_that_says_nothing_changes_nothing(
    drive: Scene, entry: TopicEntry, qos: Qos
) -> None:
    drive.state(State.ACTIVE)
    statuses = drive.island.heard[topics.STATUS]
    with Participant(drive.domains[0], DdsConfig(interface="lo"), "newcomer") as other:
        other.publisher(entry.name, entry.type_name, qos)
        known = len(statuses)
        drive.until(lambda: len(statuses) > known + 15, "it goes on")
    drive.until(lambda: len(statuses) > known + 25, "and goes on")
    assert all(one.message.state == State.ACTIVE for one in statuses[known:])
    assert not any(one.message.inputs[4].other_writers for one in statuses[known:])


@pytest.mark.parametrize("how", ["silent", "killed"])
def test_row_85_no_late_reader_receives_a_command_from_before_a_silence(
    drive: Scene, how: str
) -> None:
    drive.state(State.ACTIVE)
    commands = drive.main.heard[topics.CONTROL]
    if how == "silent":
        drive.signal(VEHICLE, signal.SIGSTOP)
        drive.state(State.SILENT)
    else:
        drive.kill(ISLAND)
        writer = commands[-1].writer
        drive.until(lambda: writer not in _publishers(drive), "the island is gone beyond it")
    for domain in drive.domains:
        with Participant(domain, DdsConfig(interface="lo"), "late") as late:
            entry = topics.CONTROL
            subscription = late.subscription(entry.name, entry.type_name, entry.qos)
            if how == "silent":
                drive.until(lambda: subscription.matched() > 0, "it has found the publisher")  # noqa: B023
            late.wait(0.5)
            assert subscription.take_all() == []


def test_row_86_a_rogue_command_does_not_pass_the_bridge(drive: Scene) -> None:
    drive.state(State.ACTIVE)
    commands = drive.main.heard[topics.CONTROL]
    known = len(commands)
    entry = topics.CONTROL
    with Participant(drive.domains[1], DdsConfig(interface="lo"), "rogue") as rogue:
        publisher = rogue.publisher(entry.name, entry.type_name, entry.qos)

        def spoof() -> None:
            stamp = Time(1, 0)
            values = (stamp, stamp, 0.7, 0.0, ROGUE_SPEED, 4.0, 0.0, True, True, False, None)
            assert publisher.write(encode_control(Control(*values)))

        drive.meanwhile = spoof
        heard = drive.island.heard[entry]
        drive.until(
            lambda: sum(one.message.velocity == ROGUE_SPEED for one in heard) > 50, "it is heard"
        )
        drive.until(lambda: len(commands) > known + 20, "commands go on")
        drive.until(lambda: "ALARM" in drive.log(BRIDGE), "the bridge raises an alarm")
    assert not any(one.message.velocity == ROGUE_SPEED for one in commands[known:])
    assert publisher.guid.hex() in drive.log(BRIDGE)


def test_the_bridge_forgets_modes_that_are_not_in_force(scene: Scene, mode: ModePublisher) -> None:
    """Whoever finds its publisher again receives the last one only."""
    for value in (Mode.STOP, Mode.AUTONOMOUS) * 3 + (Mode.STOP,):
        mode.tell(value)
        reason = Reason.NOT_AUTONOMOUS if value is Mode.STOP else Reason.NONE
        scene.status(lambda status: status.operation_mode == value, f"{value} {reason}")  # noqa: B023
    entry = topics.OPERATION_MODE
    with Participant(scene.domains[1], DdsConfig(interface="lo"), "late") as late:
        subscription = late.subscription(entry.name, entry.type_name, entry.qos.with_depth(64))
        scene.until(lambda: subscription.matched() > 0, "it has found the bridge")
        late.wait(5.0)
        samples = subscription.take_all()
    stamp = Time(0, 0)
    assert [sample.data[12:16] for sample in samples] == [
        encode_operation_mode(OperationMode(stamp, Mode.STOP, True))[12:16]
    ]


def _publishers(scene: Scene) -> set[bytes]:
    found = scene.main.participant.publications(topics.CONTROL.name)
    return {other.guid for other in found}
