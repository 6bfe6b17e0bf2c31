# SPDX-License-Identifier: Apache-2.0
"""The node over real DDS on loopback, in a process of its own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.endpoints import Subscription
from safety_island.dds.participant import Participant
from safety_island.messages.inputs import (
    Acceleration,
    Odometry,
    OperationMode,
    Steering,
    encode_acceleration,
    encode_odometry,
    encode_operation_mode,
    encode_steering,
)
from safety_island.messages.outputs import decode_control
from safety_island.messages.trajectory import encode_trajectory
from safety_island.messages.wire import Time
from safety_island.params import load_set
from safety_island.platform.posix.clock import PosixClock
from tests.node.rig import make_points

pytestmark = pytest.mark.live

LIMIT_S = 60.0
"""How long to wait for what must come."""
STOP_LIMIT_S = 1.0
"""Contract, section 3: a process that is told to stop exits within this time."""


class Island:
    """The process under test and the main compute's side of its topics."""

    def __init__(self, domain_id: int) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.node.live_island", str(domain_id)],
            cwd=Path(__file__).parents[2],
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
            stderr=subprocess.PIPE,
            text=True,
        )
        self.clock = PosixClock()
        self.participant = Participant(domain_id, DdsConfig(loopback_only=True), "main_compute")
        self.publishers = {
            entry: self.participant.publisher(entry.name, entry.type_name, entry.qos)
            for entry in topics.INPUTS
        }
        self.outputs = {
            entry: self.participant.subscription(entry.name, entry.type_name, entry.qos)
            for entry in topics.OUTPUTS
        }

    def wait_for_line(self, text: str) -> str:
        """Read the log up to a line that holds a text."""
        assert self.process.stderr is not None
        seen = []
        for line in self.process.stderr:
            seen.append(line)
            if text in line:
                return line
        raise AssertionError(f"the island ended without {text!r}: {''.join(seen)}")

    def send(self, *absent: topics.TopicEntry) -> None:
        """Publish one sample of each input but the absent ones: 1 m/s on a straight course."""
        stamp = Time.from_nanoseconds(self.clock.wall_ns())
        values = dict.fromkeys(Odometry._fields[3:], 0.0) | {"vx": 1.0, "qw": 1.0}
        values["y"] = stamp.nanosec * 1e-10  # what moves does not repeat itself
        samples = {
            topics.ODOMETRY: encode_odometry(Odometry(stamp, "map", "base_link", **values)),
            topics.STEERING: encode_steering(Steering(stamp, 0.0)),
            topics.ACCELERATION: encode_acceleration(Acceleration(stamp, "base_link", *[0.0] * 6)),
            topics.OPERATION_MODE: encode_operation_mode(OperationMode(stamp, 1, True)),
            topics.TRAJECTORY: encode_trajectory(
                stamp, "map", make_points([(x - 5.0, 0.5, 1.0) for x in range(60)])
            ),
        }
        for entry in samples.keys() - set(absent):
            assert self.publishers[entry].write(samples[entry])

    def send_until(self, done: Callable[[], bool], *absent: topics.TopicEntry) -> None:
        """Publish again and again until something has happened."""
        end = time.monotonic() + LIMIT_S
        while not done():
            assert time.monotonic() < end, "it did not happen in time"
            self.send(*absent)
            self.participant.wait(0.02)

    def close(self) -> None:
        self.process.kill()
        self.process.communicate()
        self.participant.close()


@pytest.fixture(scope="module")
def compiled() -> None:
    """Compiles the kernels, so that no test waits for that."""
    TrajectoryFollower(load_set("default"))


@pytest.fixture
def island(compiled: None, domain_id: int) -> Iterator[Island]:
    running = Island(domain_id)
    yield running
    running.close()


def has_come(subscription: Subscription) -> Callable[[], bool]:
    """A condition: a sample of the topic was taken."""
    return lambda: subscription.take_newest() is not None


def test_inputs_give_commands_and_a_missing_input_gives_none(island: Island) -> None:
    island.wait_for_line("is live")
    assert "odometry data" in island.wait_for_line("Waiting for ")
    control = island.outputs[topics.CONTROL]
    trajectory = island.publishers[topics.TRAJECTORY]
    island.send_until(lambda: trajectory.matched() > 0, topics.TRAJECTORY)
    for _ in range(2):  # the second comes three seconds after the first
        island.wait_for_line("Waiting for trajectory data")
    assert control.take_newest() is None

    island.send_until(has_come(control))
    sent_before = island.clock.wall_ns()
    newer: list[bytes] = []

    def has_new_command() -> bool:
        sample = control.take_newest()
        newer.extend([sample.data] if sample is not None else [])
        return len(newer) == 5

    island.send_until(has_new_command)
    commands = [decode_control(data) for data in newer]
    assert commands[-1].stamp.nanoseconds > sent_before
    assert [c.stamp for c in commands] == sorted({c.stamp for c in commands})
    assert commands[-1].steering_tire_angle > 0.0  # the course lies to the left
    assert commands[-1].is_defined_steering_tire_rotation_rate
    for entry in (topics.LATERAL_TIME, topics.LONGITUDINAL_TIME):
        island.send_until(has_come(island.outputs[entry]))


def test_bad_bytes_are_refused_and_commands_go_on(island: Island) -> None:
    control = island.outputs[topics.CONTROL]
    island.send_until(has_come(control))
    values = dict.fromkeys(Odometry._fields[3:], float("nan"))
    odometry = Odometry(Time.from_nanoseconds(island.clock.wall_ns()), "map", "base_link", **values)
    assert island.publishers[topics.ODOMETRY].write(encode_odometry(odometry))
    island.send_until(has_come(control), topics.ODOMETRY)
    assert "not finite" in island.wait_for_line("/localization/kinematic_state")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly(island: Island, number: signal.Signals) -> None:
    island.send_until(has_come(island.outputs[topics.CONTROL]))
    told = time.monotonic()
    island.process.send_signal(number)
    _, log = island.process.communicate(timeout=LIMIT_S)
    took_s = time.monotonic() - told
    assert island.process.returncode == 0
    assert "Traceback" not in log
    assert "safety_island ends after" in log.splitlines()[-1]
    assert took_s < STOP_LIMIT_S


def test_a_signal_while_it_waits_for_inputs(island: Island) -> None:
    island.wait_for_line("Waiting for trajectory data")
    island.process.terminate()
    island.process.communicate(timeout=LIMIT_S)
    assert island.process.returncode == 0
