# SPDX-License-Identifier: Apache-2.0
"""A stand-in for Autoware on its DDS domain: planner, vehicle, operation mode, command gate."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, Protocol

from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.qos import DEFAULT
from safety_island.messages.errors import DecodeError
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
from safety_island.node.transport import Publisher, Transport
from safety_island.platform.interfaces import Clock
from safety_island.platform.posix.clock import PosixClock
from safety_island.sim.console import Console
from safety_island.sim.courses import DEFAULT_COURSE, load_course
from safety_island.sim.fit import fit
from safety_island.sim.world import World

NODE_NAME = "main_compute"
PERIOD_NS = 25_000_000
"""The vehicle publishes at 40 Hz."""
PLAN_EVERY = 4
"""The planner publishes at 10 Hz, and so does the report."""
MAP, BODY = "map", "base_link"

Report = Callable[[str, Mapping[str, Any]], None]
"""Told an event and its values: ``status`` ten times a second, ``summary`` at the end."""


class StopEvent(Protocol):
    """What tells a loop to end; a ``threading.Event`` does."""

    def is_set(self) -> bool:
        """Whether to end."""


@dataclass(frozen=True)
class MainComputeOptions:
    """The command line of the stand-in."""

    domain: int = topics.MAIN_COMPUTE_DOMAIN
    course: str = DEFAULT_COURSE
    repeat: bool = False
    """Drive lap after lap instead of ending after the last stop."""
    engage: bool = True
    """Engage autonomous mode when commands come."""
    duration_s: float = 0.0
    """End after this time [s], wherever the vehicle is; 0: when the course is driven."""
    within_s: float = 0.0
    """Choose laps, or cut the course, so that driving takes about this time [s]; 0: do not."""
    dds: DdsConfig = field(default_factory=lambda: DdsConfig(loopback_only=True))


class MainCompute:
    """The topics of the stand-in around a world, on DDS or in memory; a context manager."""

    def __init__(self, world: World, transport: Transport, clock: Clock) -> None:
        self.world, self.clock = world, clock
        self.refused = 0  # commands that are no Control, or not finite
        self.nan_odometry = False
        """Whether the position that is published is NaN."""
        self.trajectory_offset = 0.0
        """How far [m] to the vehicle's left the published trajectory is from the planned one."""
        self.frozen: set[str] = set()
        """Topics, by their keys, on which nothing is published."""
        self._transport = transport
        self._odometry = self._publisher(topics.ODOMETRY)
        self._steering = self._publisher(topics.STEERING)
        self._acceleration = self._publisher(topics.ACCELERATION)
        self._trajectory = self._publisher(topics.TRAJECTORY)
        self._mode = self._publisher(topics.OPERATION_MODE)
        control = topics.CONTROL
        # Volatile: the last command of an island that is gone must not move the vehicle.
        self._control = transport.subscription(control.name, control.type_name, DEFAULT)
        self._told_mode: Mode | None = None

    def take_command(self) -> None:
        """Hand the newest command, when one came, to the world."""
        sample = self._control.take_newest()
        if sample is None:
            return
        try:
            command = decode_control(sample.data)
        except DecodeError:
            self.refused += 1
            return
        angle, acceleration = command.steering_tire_angle, command.acceleration
        if math.isfinite(angle) and math.isfinite(acceleration):
            self.world.offer_command(self.clock.monotonic_ns() * 1e-9, angle, acceleration)
        else:
            self.refused += 1

    def publish_vehicle(self) -> None:
        """Publish mode (when it changed), steering, acceleration and odometry of this moment."""
        world, plant = self.world, self.world.plant
        stamp = Time.from_nanoseconds(self.clock.wall_ns())
        if world.mode is not self._told_mode:
            self._told_mode = world.mode
            mode = OperationMode(stamp, world.mode, world.mode is Mode.AUTONOMOUS)
            self._mode.write(encode_operation_mode(mode))
        felt = (plant.acceleration, 0.0, 0.0, 0.0, 0.0, 0.0)
        turning = (0.0, 0.0, plant.yaw_rate)
        odometry = Odometry(stamp, MAP, BODY, *world.pose(), plant.speed, 0.0, 0.0, *turning)
        if self.nan_odometry:
            odometry = odometry._replace(x=math.nan)
        if topics.STEERING.key not in self.frozen:
            self._steering.write(encode_steering(Steering(stamp, plant.steering)))
        if topics.ACCELERATION.key not in self.frozen:
            self._acceleration.write(encode_acceleration(Acceleration(stamp, BODY, *felt)))
        if topics.ODOMETRY.key not in self.frozen:
            self._odometry.write(encode_odometry(odometry))

    def publish_plan(self) -> None:
        """Publish the trajectory ahead."""
        if topics.TRAJECTORY.key in self.frozen:
            return
        stamp = Time.from_nanoseconds(self.clock.wall_ns())
        points = self.world.planner.window()
        if self.trajectory_offset:
            yaw = self.world.plant.yaw
            points = points.copy()
            points["x"] -= self.trajectory_offset * math.sin(yaw)
            points["y"] += self.trajectory_offset * math.cos(yaw)
        self._trajectory.write(encode_trajectory(stamp, MAP, points))

    def close(self) -> None:
        """Leave the domain."""
        self._transport.close()

    def __enter__(self) -> MainCompute:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _publisher(self, topic: topics.TopicEntry) -> Publisher:
        return self._transport.publisher(topic.name, topic.type_name, topic.qos)


def run(
    options: MainComputeOptions,
    stop: StopEvent,
    clock: Clock | None = None,
    report: Report | None = None,
    say: Callable[[str], None] | None = None,
    console: Console | None = None,
) -> int:
    """Run until the course is driven, time is up, or ``stop`` is set; return the exit code.

    With a ``console`` the end of the drive is reported, autonomous mode is left, and the topics go
    on until ``stop`` is set or the console is closed: whoever follows them can leave first.
    Raises ConfigurationError for an unknown course and for what DDS cannot use.
    """
    clock = clock or PosixClock()
    course, laps = load_course(options.course), 1
    if options.within_s:
        course, laps = fit(course, options.within_s)
    participant = Participant(options.domain, options.dds, NODE_NAME)
    start = clock.monotonic_ns() * 1e-9
    world = World(
        course,
        start,
        repeat=options.repeat,
        laps=laps,
        engage=options.engage,
        say=say or _print,
    )
    end = start + options.duration_s if options.duration_s else float("inf")
    with MainCompute(world, participant, clock) as main_compute:
        loop = _Loop(main_compute, participant, report, console)
        loop.run(lambda now: stop.is_set() or loop.is_over(now, end))
        if report is not None:
            report("summary", {**world.summary(), "refused_commands": main_compute.refused})
        if console is not None:
            world.disengage()
            loop.run(lambda now: stop.is_set() or console.is_closed)
    return 0


class _Loop:
    """Publishes on a fixed grid of the monotonic clock; takes commands between."""

    def __init__(
        self,
        main_compute: MainCompute,
        participant: Participant,
        report: Report | None,
        console: Console | None,
    ) -> None:
        self._main_compute, self._participant = main_compute, participant
        self._report, self._console = report, console
        self._round = 0

    def is_over(self, now: float, end: float) -> bool:
        """Whether the drive has come to its end at ``now`` [s], at ``end`` [s] the latest."""
        console = self._console
        if console is not None and (console.has_ended or console.is_closed):
            return True
        return now >= end or self._main_compute.world.has_ended(now)

    def run(self, is_over: Callable[[float], bool]) -> None:
        """Run until it is over."""
        main_compute = self._main_compute
        clock = main_compute.clock
        due = clock.monotonic_ns()
        while not is_over(clock.monotonic_ns() * 1e-9):
            if self._participant.wait(max(0, due - clock.monotonic_ns()) * 1e-9):
                main_compute.take_command()
            if self._console is not None:
                self._console.poll(main_compute)
            now_ns = clock.monotonic_ns()
            if now_ns >= due:
                self._publish(now_ns * 1e-9)
                due += PERIOD_NS * max(1, -(-(now_ns - due) // PERIOD_NS))

    def _publish(self, now: float) -> None:
        """Move the vehicle on to ``now`` [s] and publish; every PLAN_EVERY rounds the plan too."""
        main_compute = self._main_compute
        main_compute.world.advance(now)
        main_compute.publish_vehicle()
        if self._round % PLAN_EVERY == 0:
            main_compute.publish_plan()
            if self._report is not None:
                self._report("status", main_compute.world.status(now))
        self._round += 1


def _print(text: str) -> None:
    print(f"main compute: {text}", file=sys.stderr, flush=True)
