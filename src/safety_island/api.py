# SPDX-License-Identifier: Apache-2.0
"""The Python interface: ``from safety_island import ...`` for people who script.

Controllers and simulation, without network, threads or clock: parameters in, a path in, commands
out. These are the controllers alone; the island around them (input gate, guard, life cycle, DDS,
CAN) is ``island run``. The first use compiles the control kernels, unless they are there
(``island prepare``). Units are SI: m, rad, s.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.status import Mode, Refusal
from safety_island.errors import ConfigurationError, IslandError
from safety_island.params import IslandParameters as Parameters
from safety_island.params import read
from safety_island.sim import closed_loop
from safety_island.sim.closed_loop import Row, orientation
from safety_island.sim.courses import COURSES, Course, load_course
from safety_island.sim.own_path import make_course, read_course
from safety_island.sim.planner import Planner
from safety_island.sim.plant import PlantParams as Vehicle

__all__ = [
    "COURSES",
    "Command",
    "Controller",
    "Course",
    "Drive",
    "IslandError",
    "Parameters",
    "Vehicle",
    "drive",
    "load_course",
    "load_parameters",
    "make_course",
    "read_course",
]

Array = npt.NDArray[np.float64]


def load_parameters(
    *files: str | os.PathLike[str], base: str = "default", **values: object
) -> Parameters:
    """Return a checked parameter set: a shipped one, Autoware's files over it, then ``values``.

    A value is named as in the files (``ctrl_period=0.03``). Raises IslandError with every mistake.
    """
    return read([Path(file) for file in files], base, values or None, name="value").parameters


class Command(NamedTuple):
    """What the vehicle is asked for."""

    steering: float
    """Tyre angle [rad], left is positive."""
    steering_rate: float
    """[rad/s]"""
    speed: float
    """[m/s]"""
    acceleration: float
    """[m/s^2]"""


class Controller:
    """MPC and PID along a course, one tick at a time, for a vehicle of the caller's own."""

    def __init__(self, course: Course, parameters: Parameters | None = None) -> None:
        """Start at the beginning of the course. ``parameters`` None: the default set."""
        self.parameters = parameters or load_parameters()
        self._follower = TrajectoryFollower(self.parameters)
        self._planner = Planner(course)
        self._last = -np.inf
        self._follower.offer_operation_mode(Mode.AUTONOMOUS, True)

    @property
    def start(self) -> tuple[float, float, float]:
        """Where the course starts: x, y [m], yaw [rad]."""
        return self._planner.start_pose()

    @property
    def finished(self) -> bool:
        """Whether the vehicle stands at the last stop of the course."""
        return self._planner.finished

    def step(
        self,
        now: float,
        x: float,
        y: float,
        yaw: float,
        speed: float,
        steering: float,
        acceleration: float = 0.0,
        yaw_rate: float | None = None,
    ) -> Command | None:
        """Return the command of one tick at ``now`` [s], for the vehicle's pose and motion.

        ``yaw_rate`` None: that of a vehicle without slip. None is returned when the controllers
        have no command, for example far from the course. Raises IslandError for time that does not
        go on and for a value that is no measurement.
        """
        if not now > self._last:
            raise ConfigurationError(f"now is {now:g} s, after {self._last:g} s; time must go on")
        if yaw_rate is None:
            yaw_rate = self._turn_rate(speed, steering)
        follower, place = self._follower, self._planner.update(now, x, y, speed)
        pose = orientation(yaw, place.pitch)
        for name, refusal in (
            ("pose or speed", follower.offer_odometry(x, y, 0.0, *pose, speed, 0.0, yaw_rate)),
            ("steering", follower.offer_steering(steering)),
            ("acceleration", follower.offer_acceleration(acceleration)),
            ("course", follower.offer_trajectory(self._planner.window(), now)),
        ):
            if refusal is not Refusal.ACCEPTED:
                raise ConfigurationError(f"{name} at {now:g} s was refused: {refusal.name}")
        self._last = now
        return self._command() if follower.step(now) else None

    def _turn_rate(self, speed: float, steering: float) -> float:
        """Of a vehicle without slip [rad/s]; 0 for what is no number, which is refused as such."""
        rate = speed * math.tan(steering) if math.isfinite(steering) else 0.0
        return rate / self.parameters.vehicle.wheel_base if math.isfinite(rate) else 0.0

    def _command(self) -> Command:
        row = self._follower.command[0]
        names = ("steering_tire_angle", "steering_tire_rotation_rate", "velocity", "acceleration")
        return Command(*(float(row[name]) for name in names))


@dataclass(frozen=True)
class Drive:
    """A drive in virtual time: one value for each tick, and how it went as a whole."""

    time: Array
    """Since the start [s]."""
    x: Array
    y: Array
    yaw: Array
    speed: Array
    """Of the vehicle [m/s]."""
    steering: Array
    """Tyre angle of the vehicle [rad]."""
    steering_command: Array
    acceleration_command: Array
    station: Array
    """Distance along the course [m]."""
    lateral_error: Array
    """Distance from the course [m], left is positive."""
    target_speed: Array
    """Of the course [m/s]."""
    stop_errors: tuple[float, ...]
    """Distance [m] of each stop from its place, beyond it is positive."""
    finished: bool
    """Whether the last stop was reached."""


def drive(
    course: Course,
    parameters: Parameters | None = None,
    *,
    vehicle: Vehicle | None = None,
    limit: float | None = None,
) -> Drive:
    """Drive a course with the simulated vehicle, in virtual time; the same every time.

    ``parameters`` None: the default set; ``vehicle`` None: one with the wheelbase of the
    parameters; ``limit`` [s] None: 1.5 times what the course takes at its speeds.
    """
    parameters = parameters or load_parameters()
    vehicle = vehicle or Vehicle(wheelbase=parameters.vehicle.wheel_base)
    follower, period = TrajectoryFollower(parameters), parameters.node.ctrl_period
    done = closed_loop.drive(follower, course, period, limit_s=limit, plant=vehicle)
    table = np.array(done.rows, np.float64).reshape(-1, len(Row._fields))
    columns = dict(zip(Row._fields, table.T, strict=True))
    time = columns.pop("now") - closed_loop.START_S
    steering = columns.pop("angle_command")
    stops = tuple(done.metrics.stop_errors)
    return Drive(
        time, steering_command=steering, stop_errors=stops, finished=done.finished, **columns
    )
