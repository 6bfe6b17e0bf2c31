# SPDX-License-Identifier: Apache-2.0
"""The stand-in on its DDS domain, with a neighbour that listens and commands."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import pytest

from safety_island.dds import topics
from safety_island.dds.config import URI, DdsConfig
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.participant import Participant
from safety_island.errors import ConfigurationError
from safety_island.messages.inputs import decode_odometry, decode_operation_mode
from safety_island.messages.outputs import Control, encode_control
from safety_island.messages.trajectory import decode_trajectory
from safety_island.messages.wire import Time
from safety_island.sim.main_compute import MainCompute, MainComputeOptions, run
from tests.dds.waiting import wait_for

LOOPBACK = DdsConfig(loopback_only=True)


class Neighbour:
    """What the island is to the stand-in, and what the stand-in reports."""

    def __init__(self, domain_id: int) -> None:
        self.domain_id = domain_id
        self.participant = Participant(domain_id, LOOPBACK, "island")
        self.inputs = {topic.key: self._subscription(topic) for topic in topics.INPUTS}
        control = topics.CONTROL
        self.control: Publisher = self.participant.publisher(
            control.name, control.type_name, control.qos
        )
        self.events: list[tuple[str, Mapping[str, Any]]] = []
        self.said: list[str] = []
        self.stop = threading.Event()

    def _subscription(self, topic: topics.TopicEntry) -> Subscription:
        return self.participant.subscription(topic.name, topic.type_name, topic.subscription_qos)

    @contextmanager
    def stand_in(self, console: Any = None, **options: Any) -> Iterator[None]:
        """Run the stand-in in a thread."""
        chosen = MainComputeOptions(domain=self.domain_id, dds=LOOPBACK, **options)
        report, say = (lambda *event: self.events.append(event)), self.said.append
        arguments = (chosen, self.stop, None, report, say, console)
        thread = self.thread = threading.Thread(target=run, args=arguments)
        thread.start()
        try:
            yield
        finally:
            self.stop.set()
            thread.join()

    def status(self, name: str) -> Any:
        """A value of the newest status; None before the first."""
        found = [values for kind, values in self.events if kind == "status"]
        return found[-1][name] if found else None

    def command(self, acceleration: float) -> None:
        """Send a command."""
        assert self.control.write(
            encode_control(Control(Time(), Time(), 0.0, 0.0, 1.0, acceleration))
        )


@pytest.fixture
def neighbour(domain_id: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[Neighbour]:
    monkeypatch.delenv(URI, raising=False)
    found = Neighbour(domain_id)
    yield found
    found.participant.close()


def test_publishes_all_inputs_of_the_island(neighbour: Neighbour) -> None:
    with neighbour.stand_in(course="s-curve"):
        samples = {
            key: wait_for(subscription.take_newest)
            for key, subscription in neighbour.inputs.items()
        }
    odometry = decode_odometry(samples["odometry"].data)
    assert (odometry.frame_id, odometry.child_frame_id) == ("map", "base_link")
    assert (odometry.x, odometry.y) == pytest.approx((10.0, 0.0))
    assert (odometry.qw, odometry.vx) == (1.0, 0.0)
    assert abs(odometry.stamp.seconds - time.time()) < 60.0
    trajectory = decode_trajectory(samples["trajectory"].data)
    assert len(trajectory.points) == 220
    assert trajectory.points["x"][0] == 0.0
    mode = decode_operation_mode(samples["operation_mode"].data)
    assert (mode.mode, mode.is_autoware_control_enabled) == (1, False)


def test_rates(neighbour: Neighbour) -> None:
    """Four samples of each vehicle topic come with each trajectory."""
    with neighbour.stand_in():
        wait_for(lambda: neighbour.status("operation_mode") == "STOP")
        received = neighbour.inputs["trajectory"]
        wait_for(lambda: received.take_newest() and received.received > 10)
        neighbour.inputs["odometry"].take_newest()
    ratio = neighbour.inputs["odometry"].received / received.received
    assert 3.0 < ratio < 5.0


def test_engages_drives_brakes_and_goes_on(neighbour: Neighbour) -> None:
    modes = neighbour.inputs["operation_mode"]

    def engaged() -> bool:
        neighbour.command(1.0)
        sample = modes.take_newest()
        return sample is not None and decode_operation_mode(sample.data).mode == 2

    def drives() -> bool:
        neighbour.command(2.0)
        return bool(neighbour.status("gate") == "driving" and neighbour.status("speed") > 0.3)

    with neighbour.stand_in():
        wait_for(lambda: neighbour.control.matched())
        wait_for(engaged)
        wait_for(drives)
        wait_for(lambda: neighbour.status("gate") == "braking")
        wait_for(lambda: neighbour.status("speed") == 0.0)
        wait_for(drives)
    assert neighbour.said == [
        "commands come: autonomous mode engaged",
        "commands stopped coming: braking",
        "commands come: autonomous mode engaged",
        "commands are back",
    ]
    kind, summary = neighbour.events[-1]
    assert (kind, summary["silences"], summary["finished"]) == ("summary", 1, False)


def test_what_is_no_command_does_not_drive(neighbour: Neighbour) -> None:
    """A NaN passes the wire; the vehicle refuses it."""
    with neighbour.stand_in():
        wait_for(lambda: neighbour.control.matched())
        for _ in range(5):
            neighbour.command(float("nan"))
        wait_for(lambda: neighbour.status("operation_mode") == "STOP")
    assert neighbour.events[-1][1]["refused_commands"] > 0
    assert neighbour.events[-1][1]["commands"] == 0


def test_ends_when_told_within_a_second(neighbour: Neighbour) -> None:
    with neighbour.stand_in():
        wait_for(lambda: neighbour.events)
        told = time.monotonic()
    assert time.monotonic() - told < 1.0
    assert neighbour.events[-1][0] == "summary"


def test_ends_after_its_duration(domain_id: int) -> None:
    options = MainComputeOptions(domain=domain_id, dds=LOOPBACK, duration_s=0.1)
    assert run(options, threading.Event(), say=lambda _: None) == 0


def test_an_unknown_course() -> None:
    with pytest.raises(ConfigurationError, match="unknown course 'x'"):
        run(MainComputeOptions(course="x"), threading.Event())


class Console:
    """Stands in for the lines on standard input."""

    def __init__(self) -> None:
        self.has_ended = self.is_closed = False
        self.act: list[Callable[[MainCompute], None]] = []

    def poll(self, main_compute: MainCompute) -> None:
        while self.act:
            self.act.pop(0)(main_compute)


def test_topics_go_on_after_the_drive_until_the_console_is_closed(neighbour: Neighbour) -> None:
    """Whoever follows the main compute can leave before it does, and misses nothing."""
    console, modes = Console(), neighbour.inputs["operation_mode"]
    with neighbour.stand_in(console):
        wait_for(lambda: neighbour.control.matched())

        def engaged() -> bool:
            neighbour.command(1.0)
            return bool(neighbour.status("operation_mode") == "AUTONOMOUS")

        wait_for(engaged)
        console.has_ended = True
        wait_for(lambda: any(kind == "summary" for kind, _ in neighbour.events))
        wait_for(lambda: (s := modes.take_newest()) and decode_operation_mode(s.data).mode == 1)
        received = neighbour.inputs["odometry"].received
        wait_for(
            lambda: (
                neighbour.inputs["odometry"].take_newest()
                and neighbour.inputs["odometry"].received > received + 10
            )
        )
        console.is_closed = True
        wait_for(lambda: not neighbour.thread.is_alive())
    assert sum(kind == "summary" for kind, _ in neighbour.events) == 1


def test_faults_on_the_topics(neighbour: Neighbour) -> None:
    console, odometry = Console(), neighbour.inputs["odometry"]
    with neighbour.stand_in(console):
        wait_for(odometry.take_newest)

        def is_nan() -> bool:
            sample = odometry.take_newest()
            return sample is not None and math.isnan(decode_odometry(sample.data).x)

        console.act.append(lambda main_compute: setattr(main_compute, "nan_odometry", True))
        wait_for(is_nan)
        console.act.append(lambda main_compute: setattr(main_compute, "nan_odometry", False))
        wait_for(lambda: not is_nan())
        trajectory = neighbour.inputs["trajectory"]

        def left_of_the_vehicle() -> float:
            """How far the trajectory is beside the vehicle, which stands with yaw 0."""
            path, place = trajectory.take_newest(), odometry.take_newest()
            if path is None or place is None:
                return math.nan
            y = float(decode_trajectory(path.data).points["y"][0])
            return y - decode_odometry(place.data).y

        console.act.append(lambda main_compute: setattr(main_compute, "trajectory_offset", 6.0))
        wait_for(lambda: left_of_the_vehicle() > 5.0)
        console.act.append(lambda main_compute: setattr(main_compute, "trajectory_offset", 0.0))
        wait_for(lambda: left_of_the_vehicle() < 1.0)
        console.act.append(lambda main_compute: main_compute.frozen.add("odometry"))
        wait_for(lambda: not console.act)
        odometry.take_newest()
        before = odometry.received
        steering = neighbour.inputs["steering"]
        steering.take_newest()
        more = steering.received + 20
        wait_for(lambda: steering.take_newest() and steering.received > more)
        odometry.take_newest()
        assert odometry.received <= before + 1
        console.is_closed = True
