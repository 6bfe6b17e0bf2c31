# SPDX-License-Identifier: Apache-2.0
"""Drives of the whole node with random parameters and disturbances, in memory on virtual time."""

from __future__ import annotations

import math
from random import Random
from typing import Any

import numpy as np

from safety_island import params
from safety_island.control.follower import TrajectoryFollower
from safety_island.control.records import COMMAND
from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.kernel.records import Records
from safety_island.messages import inputs as codec
from safety_island.messages.outputs import Control, decode_control
from safety_island.messages.trajectory import encode_trajectory
from safety_island.messages.wire import Time
from safety_island.node import ControllerNode
from safety_island.node.memory import MemoryDomain
from safety_island.params import IslandParameters, ParameterError
from safety_island.platform.interfaces import LogConfig, LogLevel
from safety_island.platform.sim import make
from safety_island.sim.closed_loop import START_S, ClosedLoop
from safety_island.sim.courses import COURSES, load_course
from safety_island.sim.plant import PlantParams

RANGES: dict[str, tuple[float, float]] = {
    "wheel_base": (1.5, 4.0),
    "max_steer_angle": (0.3, 1.0),
    "vehicle_model_steer_tau": (0.05, 0.6),
    "input_delay": (0.0, 0.3),
    "steering_lpf_cutoff_hz": (1.0, 3.0),
    "velocity_time_constant": (0.1, 1.0),
    "acceleration_limit": (0.5, 5.0),
    "mpc_weight_lat_error": (0.05, 3.0),
    "mpc_weight_steering_input": (0.05, 3.0),
    "mpc_weight_lat_jerk": (0.0, 0.5),
    "delay_compensation_time": (0.0, 0.5),
    "kp": (0.1, 5.0),
    "ki": (0.0, 1.0),
    "kd": (0.0, 0.5),
    "max_out": (0.5, 4.0),
    "min_out": (-6.0, -0.5),
    "max_p_effort": (0.5, 4.0),
    "min_p_effort": (-6.0, -0.5),
    "lpf_vel_error_gain": (0.0, 0.95),
    "max_acc": (1.0, 6.0),
    "min_acc": (-9.0, -3.0),
    "max_jerk": (1.0, 10.0),
    "min_jerk": (-15.0, -1.5),
    "max_acc_cmd_diff": (10.0, 300.0),
    "stopped_acc": (-8.0, -1.0),
    "emergency_acc": (-9.0, -2.0),
    "emergency_jerk": (-20.0, -1.5),
    "smooth_stop_strong_stop_acc": (-6.0, -1.0),
    "smooth_stop_min_strong_acc": (-4.0, -1.0),
    "smooth_stop_max_strong_acc": (-1.0, -0.3),
    "acc_feedback_gain": (0.0, 0.8),
    "max_pitch_rad": (0.05, 0.3),
    "min_pitch_rad": (-0.3, -0.05),
}
"""Keys, and what a vehicle's own files may well say."""

CHOICES: dict[str, tuple[object, ...]] = {
    "ctrl_period": (0.03, 0.05, 0.1, 0.15),
    "vehicle_model_type": ("kinematics", "kinematics_no_delay"),
    "slope_source": ("raw_pitch", "trajectory_pitch", "trajectory_adaptive"),
    "use_steer_prediction": (False, True),
    "enable_smooth_stop": (False, True),
    "enable_slope_compensation": (False, True),
    "enable_keep_stopped_until_steer_convergence": (False, True),
    "enable_path_smoothing": (False, True),
}


def random_parameters(random: Random) -> IslandParameters:
    """About half of the keys changed, over the set ``firmware``; what does not fit is redrawn."""
    while True:
        values: dict[str, Any] = {key: random.choice(among) for key, among in CHOICES.items()}
        values |= {
            key: random.uniform(*limits) for key, limits in RANGES.items() if random.random() < 0.5
        }
        try:
            return params.from_mapping(values, "firmware")
        except ParameterError:
            continue


class NodeFollower:
    """The node in place of its controllers: offered values become messages, commands are read back.

    It disturbs the drive: now and then the vehicle is set aside, the trajectory asks for reverse,
    or autonomous mode is left for a while.
    """

    def __init__(self, parameters: IslandParameters, random: Random) -> None:
        self.platform = make(LogConfig(level=LogLevel.NONE))
        self.domain = MemoryDomain(self.platform.clock)
        self.follower = TrajectoryFollower(parameters)
        self.node = ControllerNode(self.platform, self.domain, self.follower, parameters)
        self._write = {
            topic.key: self.domain.publisher(topic.name, topic.type_name, topic.qos).write
            for topic in topics.INPUTS
        }
        entry = topics.CONTROL
        self._published = self.domain.subscription(entry.name, entry.type_name, entry.qos)
        self._random, self._now = random, START_S
        self._aside = self._reverse = self._manual = 0
        self.command: Records = np.zeros(1, COMMAND)
        self.published: Control | None = None

    def at(self, now: float) -> None:
        """Set the clock for what is offered next."""
        self._now = now
        self.platform.clock.advance_to_ns(round(now * 1e9))

    def disturb(self, now: float) -> None:
        """Set the clock, and choose what goes wrong."""
        self.at(now)
        for name in ("_aside", "_reverse", "_manual"):
            left = getattr(self, name)
            started = self._random.randrange(5, 25) if self._random.random() < 0.006 else 0
            setattr(self, name, left - 1 if left else started)

    def offer_trajectory(self, points: Records, stamp: float) -> None:
        if self._reverse:
            points = points.copy()
            points["v"] *= -1.0
        message = encode_trajectory(self._stamp(stamp), "map", points)
        self._write["trajectory"](message)

    def offer_odometry(self, x: float, y: float, *rest: float) -> None:
        stamp, aside = self._stamp(self._now), 2.0 if self._aside else 0.0
        names = ("z", "qx", "qy", "qz", "qw", "vx", "vy", "wz")
        noise = self._random.gauss(0.0, 1e-3)
        values = dict(zip(names, rest, strict=True)) | {"vx": rest[5] + noise}
        message = codec.Odometry(
            stamp, "map", "base_link", x=x, y=y + aside, **values, vz=0.0, wx=0.0, wy=0.0
        )
        self._write["odometry"](codec.encode_odometry(message))

    def offer_steering(self, angle: float) -> None:
        message = codec.Steering(self._stamp(self._now), angle + self._random.gauss(0.0, 1e-3))
        self._write["steering"](codec.encode_steering(message))

    def offer_acceleration(self, ax: float) -> None:
        noisy = ax + self._random.gauss(0.0, 0.05)
        message = codec.Acceleration(self._stamp(self._now), "base_link", noisy, *(0.0,) * 5)
        self._write["acceleration"](codec.encode_acceleration(message))

    def offer_operation_mode(self, mode: int, enabled: bool) -> None:
        chosen = int(Mode.STOP) if self._manual else mode
        message = codec.OperationMode(self._stamp(self._now), chosen, enabled)
        self._write["operation_mode"](codec.encode_operation_mode(message))

    def step(self, now: float) -> None:
        self.node.tick(now)
        sample = self._published.take_newest()
        self.published = None if sample is None else decode_control(sample.data)
        if self.published is not None:
            for name in COLUMNS:
                self.command[name] = getattr(self.published, name)

    @staticmethod
    def _stamp(seconds: float) -> Time:
        return Time.from_seconds(seconds)


COLUMNS = ("steering_tire_angle", "steering_tire_rotation_rate", "velocity", "acceleration")
"""Fields of a command, of the message and of COMMAND alike."""


def random_drive(seed: int) -> tuple[NodeFollower, ClosedLoop]:
    """A drive that is not yet driven; the same for the same seed."""
    random = Random(seed)
    parameters = random_parameters(random)
    follower = NodeFollower(parameters, random)
    vehicle = PlantParams(
        wheelbase=parameters.vehicle.wheel_base, steering_lag=random.uniform(0.05, 0.5)
    )
    course = load_course(random.choice(sorted(COURSES)))
    loop = ClosedLoop(follower, course, parameters.node.ctrl_period, plant=vehicle)
    loop.plant.steering = random.uniform(-0.3, 0.3)
    return follower, loop


def is_finite(command: Control) -> bool:
    """Whether every value of a command is a number."""
    return all(math.isfinite(getattr(command, name)) for name in COLUMNS)
