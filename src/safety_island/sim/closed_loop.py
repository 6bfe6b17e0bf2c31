# SPDX-License-Identifier: Apache-2.0
"""Controller, vehicle and planner in one loop on virtual time: no sockets, no clock, no threads."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from safety_island.control.status import Mode
from safety_island.errors import ConfigurationError
from safety_island.kernel.records import Records
from safety_island.sim.courses import Course
from safety_island.sim.metrics import Metrics
from safety_island.sim.planner import Planner
from safety_island.sim.plant import STEP_S, Plant, PlantParams

START_S = 1000.0
"""Virtual time at which a drive begins [s]."""

PLANNER_PERIOD_S = 0.1
"""The planner publishes at the first tick after this much time."""


class Follower(Protocol):
    """What the loop needs of a trajectory follower; units as in ``control.records.INPUTS``."""

    def offer_trajectory(self, points: Records, stamp: float) -> object: ...
    def offer_odometry(
        self,
        x: float,
        y: float,
        z: float,
        qx: float,
        qy: float,
        qz: float,
        qw: float,
        vx: float,
        vy: float,
        wz: float,
    ) -> object: ...
    def offer_steering(self, angle: float) -> object: ...
    def offer_acceleration(self, ax: float) -> object: ...
    def offer_operation_mode(self, mode: int, enabled: bool) -> object: ...
    def step(self, now: float) -> object: ...
    @property
    def command(self) -> Records: ...


class Row(NamedTuple):
    """One tick: time [s], pose [m, rad], motion, command, place on the course."""

    now: float
    x: float
    y: float
    yaw: float
    speed: float
    steering: float
    angle_command: float
    acceleration_command: float
    station: float
    lateral_error: float
    target_speed: float


@dataclass(frozen=True)
class Drive:
    """What came of a drive."""

    rows: list[Row]
    metrics: Metrics
    finished: bool
    """Whether the last stop of the course was reached."""


class ClosedLoop:
    """Drives a follower along a course, one control period at a time."""

    def __init__(
        self,
        follower: Follower,
        course: Course,
        period_s: float,
        *,
        plant: PlantParams | None = None,
        repeat: bool = False,
    ) -> None:
        self._steps = round(period_s / STEP_S)
        if self._steps < 1 or not math.isclose(self._steps * STEP_S, period_s):
            raise ConfigurationError(
                f"period {period_s} s cannot be simulated: give a multiple of {STEP_S} s"
            )
        self.follower, self.period_s = follower, period_s
        self.planner = Planner(course, repeat=repeat)
        x, y, yaw = self.planner.start_pose()
        self.plant = Plant(plant, x=x, y=y, yaw=yaw)
        self.metrics = Metrics(stop_errors=self.planner.stop_errors)
        self.ticks = 0
        self._next_plan = START_S

    @property
    def now(self) -> float:
        """Virtual time of the next tick [s]."""
        return START_S + self.ticks * self.period_s

    def tick(self) -> Row:
        """Deliver the inputs, run one step of the follower, move the vehicle on."""
        now, plant = self.now, self.plant
        place = self.planner.update(now, plant.x, plant.y, plant.speed)
        self.metrics.update(now, place, plant.speed)
        if now >= self._next_plan - 1e-9:
            self._next_plan = now + PLANNER_PERIOD_S
            self.follower.offer_trajectory(self.planner.window(), now)
        self._deliver_vehicle(place.height, place.pitch)
        self.follower.step(now)
        command = self.follower.command[0]
        angle, acceleration = float(command["steering_tire_angle"]), float(command["acceleration"])
        row = Row(
            now, plant.x, plant.y, plant.yaw, plant.speed, plant.steering, angle, acceleration,
            place.station, place.lateral_error, place.speed,
        )  # fmt: skip
        plant.command(angle, acceleration)
        plant.advance(self._steps, place.pitch)
        self.ticks += 1
        return row

    def _deliver_vehicle(self, height: float, pitch: float) -> None:
        plant, follower = self.plant, self.follower
        pose = orientation(plant.yaw, pitch)
        follower.offer_odometry(plant.x, plant.y, height, *pose, plant.speed, 0.0, plant.yaw_rate)
        follower.offer_steering(plant.steering)
        follower.offer_acceleration(plant.acceleration)
        follower.offer_operation_mode(Mode.AUTONOMOUS, True)


def orientation(yaw: float, pitch: float) -> tuple[float, float, float, float]:
    """Quaternion (x, y, z, w) of a heading [rad] on a slope [rad], positive uphill."""
    sin_yaw, cos_yaw = math.sin(0.5 * yaw), math.cos(0.5 * yaw)
    sin_pitch, cos_pitch = math.sin(0.5 * pitch), math.cos(0.5 * pitch)
    return sin_yaw * sin_pitch, -cos_yaw * sin_pitch, sin_yaw * cos_pitch, cos_yaw * cos_pitch


def drive(
    follower: Follower,
    course: Course,
    period_s: float,
    *,
    limit_s: float | None = None,
    plant: PlantParams | None = None,
) -> Drive:
    """Drive a course to its last stop, or for ``limit_s`` [s] (default: 1.5 times its duration)."""
    loop = ClosedLoop(follower, course, period_s, plant=plant)
    end = START_S + (1.5 * course.duration if limit_s is None else limit_s)
    rows = []
    while loop.now < end and not loop.planner.finished:
        rows.append(loop.tick())
    return Drive(rows, loop.metrics, loop.planner.finished)
