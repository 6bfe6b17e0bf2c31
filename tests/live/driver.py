# SPDX-License-Identifier: Apache-2.0
"""A main compute that says what a test wants: 1 m/s on a straight course, and what is wrong."""

from __future__ import annotations

import math
from collections.abc import Iterable

from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.topics import TopicEntry
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
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
from safety_island.messages.trajectory import encode_trajectory
from safety_island.messages.wire import Time
from safety_island.platform.posix.clock import PosixClock
from tests.live.scene import Scene
from tests.node.rig import make_points

PERIOD_S = 0.025
POINTS = make_points([(x - 5.0, 0.0, 1.0) for x in range(60)])


class Driver:
    """Publishes every input but the ``absent`` ones; the mode when it changes, as Autoware does.

    ``entries``: on which topics there is a publisher at all. ``speed`` [m/s] NaN: odometry that is
    no number. ``ahead_ns``: of the clock of its stamps. ``mode_depth``: how many modes it keeps for
    late subscriptions.
    """

    def __init__(
        self,
        domain: int,
        mode: Mode = Mode.AUTONOMOUS,
        mode_depth: int = 1,
        *,
        entries: Iterable[TopicEntry] = topics.INPUTS,
    ) -> None:
        self.speed = 1.0
        self.ahead_ns = 0
        self.absent: set[TopicEntry] = set()
        self._clock = PosixClock()
        self._participant = Participant(domain, DdsConfig(interface="lo"), "main_compute")
        self._publishers = {
            entry: self._participant.publisher(entry.name, entry.type_name, entry.qos)
            for entry in entries
            if entry is not topics.OPERATION_MODE
        }
        if topics.OPERATION_MODE in entries:
            entry = topics.OPERATION_MODE
            qos = entry.qos.with_depth(mode_depth)
            mode_publisher = self._participant.publisher(entry.name, entry.type_name, qos)
            self._publishers[entry] = mode_publisher
        self._due = -math.inf
        if topics.OPERATION_MODE in self._publishers:
            self.tell(mode)

    def tell(self, mode: Mode) -> None:
        """Publish an operation mode."""
        message = OperationMode(self._stamp(), mode, mode is Mode.AUTONOMOUS)
        self._write(topics.OPERATION_MODE, encode_operation_mode(message))

    def engage(self, scene: Scene) -> None:
        """Leave AUTONOMOUS and enter it again; wait until the island is ACTIVE."""
        self.tell(Mode.STOP)
        scene.state(State.READY, Reason.NOT_AUTONOMOUS)
        self.tell(Mode.AUTONOMOUS)
        scene.state(State.ACTIVE)

    def send(self) -> None:
        """Publish one sample of each input when it is time; not of the operation mode."""
        now = self._clock.monotonic_ns() / 1e9
        if now < self._due:
            return
        self._due = now + PERIOD_S
        stamp = self._stamp()
        for entry, data in self._samples(stamp).items():
            if entry not in self.absent:
                self._write(entry, data)

    def _samples(self, stamp: Time) -> dict[TopicEntry, bytes]:
        values = dict.fromkeys(Odometry._fields[3:], 0.0) | {"vx": self.speed, "qw": 1.0}
        values["y"] = stamp.nanosec * 1e-12  # what moves does not repeat itself
        return {
            topics.ODOMETRY: encode_odometry(Odometry(stamp, "map", "base_link", **values)),
            topics.STEERING: encode_steering(Steering(stamp, 0.0)),
            topics.ACCELERATION: encode_acceleration(Acceleration(stamp, "base_link", *[0.0] * 6)),
            topics.TRAJECTORY: encode_trajectory(stamp, "map", POINTS),
        }

    def _write(self, entry: TopicEntry, data: bytes) -> None:
        assert self._publishers[entry].write(data)

    def _stamp(self) -> Time:
        return Time.from_nanoseconds(self._clock.wall_ns() + self.ahead_ns)

    def close(self) -> None:
        """Leave the domain."""
        self._participant.close()
