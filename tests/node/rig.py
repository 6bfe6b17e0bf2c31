# SPDX-License-Identifier: Apache-2.0
"""A controller node in virtual time with hands on its topics, and a follower that only records."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from safety_island.can.mode import OutputMode
from safety_island.control.records import COMMAND, POINT, TRACE, new_points
from safety_island.control.status import Mode, MpcStatus, Refusal
from safety_island.dds import topics
from safety_island.dds.topics import TopicEntry
from safety_island.kernel.records import Records
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
from safety_island.messages.outputs import Control, decode_control
from safety_island.messages.trajectory import encode_trajectory
from safety_island.messages.wire import Time
from safety_island.node.controller import ControllerNode
from safety_island.node.follower import Follower
from safety_island.node.memory import MemoryDomain
from safety_island.node.outputs import Output
from safety_island.node.report import TickReport
from safety_island.params import from_mapping
from safety_island.platform import LogConfig
from safety_island.platform.sim import make

Point = tuple[float, float, float]
"""x [m], y [m], speed [m/s]."""

ROWS: list[Point] = [(0.0, 0.0, 1.0), (1.0, 0.0, 1.0), (2.0, 0.0, 1.0)]
"""A trajectory for tests that care little which."""


def make_points(rows: Sequence[Point]) -> Records:
    """Points with level, forward orientation."""
    points = np.zeros(len(rows), POINT)
    points["qw"] = 1.0
    for i, name in enumerate(("x", "y", "v")):
        points[name] = [row[i] for row in rows]
    return points


class FakeFollower:
    """Accepts what it is told to accept, and gives the command that it was given."""

    def __init__(self) -> None:
        self.calls: list[tuple[Any, ...]] = []
        self.absent = ["trajectory", "odometry", "steering", "acceleration", "operation mode"]
        self.refusal = Refusal.ACCEPTED
        self.ready = True
        self.turned_points = 0
        self.lateral_status = MpcStatus.SOLVED
        self.longitudinal_state = 0
        self.incoming = new_points()
        self.command: Records = np.zeros(1, COMMAND)
        self.trace: Records = np.zeros(1, TRACE)
        self.command["steering_tire_angle"] = 0.125
        self.command["acceleration"] = -1.5

    def _offer(self, name: str, *values: Any) -> Refusal:
        self.calls.append((name, *values))
        if self.refusal is Refusal.ACCEPTED and name in self.absent:
            self.absent.remove(name)
        return self.refusal

    def offer_incoming(self, n: int, stamp: float, start: float = 0.0) -> Refusal:
        return self._offer("trajectory", self.incoming["x"][:n].tolist(), stamp)

    def offer_odometry(self, *values: float) -> Refusal:
        return self._offer("odometry", *values)

    def offer_steering(self, angle: float) -> Refusal:
        return self._offer("steering", angle)

    def offer_acceleration(self, ax: float) -> Refusal:
        return self._offer("acceleration", ax)

    def offer_steering_offset(self, offset: float) -> Refusal:
        """Accept anything."""
        self.steering_offset = offset
        return Refusal.ACCEPTED

    def offer_operation_mode(self, mode: int, enabled: bool) -> Refusal:
        return self._offer("operation mode", mode, enabled)

    def missing(self) -> tuple[str, ...]:
        return tuple(self.absent)

    def allow_control(self, allowed: bool) -> None:
        self.allowed = allowed

    def is_ready(self) -> bool:
        self.calls.append(("is_ready",))
        return self.ready

    def run_lateral(self, now: float) -> MpcStatus:
        self.calls.append(("lateral", now))
        return self.lateral_status

    def run_longitudinal(self, now: float) -> int:
        self.calls.append(("longitudinal", now))
        self.command["longitudinal_stamp"] = now
        return self.longitudinal_state

    def sync(self) -> None:
        self.calls.append(("sync",))


class Rig:
    """The node under test and everything around it; inputs have the values of upstream's tests."""

    def __init__(
        self,
        follower: Follower,
        outputs: Sequence[Output] | None = None,
        log: LogConfig | None = None,
        mode: OutputMode = OutputMode.DDS_ONLY,
        **overrides: object,
    ) -> None:
        self.platform = make(log)
        self.clock = self.platform.clock
        self.domain = MemoryDomain(self.clock)
        self.commands = self.listen(topics.CONTROL)
        self.node = ControllerNode(
            self.platform,
            self.domain,
            follower,
            from_mapping(overrides),
            outputs,
            mode=mode,
        )
        self._publishers = {
            entry: self.domain.publisher(entry.name, entry.type_name, entry.qos)
            for entry in topics.INPUTS
        }

    def listen(self, entry: TopicEntry) -> Any:
        return self.domain.subscription(entry.name, entry.type_name, entry.qos)

    @property
    def lines(self) -> list[str]:
        return self.platform.logger.lines

    @property
    def stamp(self) -> Time:
        return Time.from_nanoseconds(self.clock.wall_ns())

    def send(self, entry: TopicEntry, data: bytes) -> None:
        self._publishers[entry].write(data)

    def odometry(self, vx: float = 0.0, x: float = 0.0, y: float = 0.0) -> None:
        values = dict.fromkeys(Odometry._fields[3:], 0.0) | {"vx": vx, "x": x, "y": y, "qw": 1.0}
        self.send(
            topics.ODOMETRY, encode_odometry(Odometry(self.stamp, "map", "base_link", **values))
        )

    def steering(self, angle: float = 0.0) -> None:
        self.send(topics.STEERING, encode_steering(Steering(self.stamp, angle)))

    def acceleration(self, ax: float = 0.0) -> None:
        message = Acceleration(self.stamp, "base_link", ax, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.send(topics.ACCELERATION, encode_acceleration(message))

    def mode(self, mode: Mode = Mode.AUTONOMOUS, enabled: bool = False) -> None:
        message = OperationMode(self.stamp, mode, enabled)
        self.send(topics.OPERATION_MODE, encode_operation_mode(message))

    def trajectory(self, rows: Sequence[Point]) -> None:
        self.send(topics.TRAJECTORY, encode_trajectory(self.stamp, "map", make_points(rows)))

    def everything(self, rows: Sequence[Point], vx: float = 0.0, steer: float = 0.0) -> None:
        self.odometry(vx)
        self.steering(steer)
        self.acceleration()
        self.mode()
        self.trajectory(rows)

    def tick(self, after_s: float = 0.15) -> TickReport:
        """One tick, that much virtual time later."""
        self.clock.advance_to_ns(self.clock.monotonic_ns() + round(after_s * 1e9))
        return self.node.tick()

    def command(self) -> Control | None:
        """The newest published command that was not read yet."""
        sample = self.commands.take_newest()
        return decode_control(sample.data) if sample is not None else None
