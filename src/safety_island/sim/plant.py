# SPDX-License-Identifier: Apache-2.0
"""The vehicle of the simulation: a kinematic bicycle behind lagging, delayed actuators.

Not modelled: tyre slip, load transfer, limits of steering angle and rate, engine and brake maps,
sensor noise. A negative acceleration command is a brake: it works against the motion, whichever
way that is, and holds the vehicle at rest; a positive one drives along the gear, and a vehicle that
drives too little on a slope rolls back.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

STEP_S = 0.005
"""One integration step [s]."""

GRAVITY = 9.81
"""[m/s^2]."""


@dataclass(frozen=True)
class PlantParams:
    """Wheelbase [m]; lags and dead times [s]. The defaults made the golden runs."""

    wheelbase: float = 2.74
    steering_lag: float = 0.2
    steering_dead_time: float = 0.06
    acceleration_lag: float = 0.15
    acceleration_dead_time: float = 0.06


class DeadTime:
    """A command that takes effect a whole number of steps after it was given."""

    def __init__(self, seconds: float) -> None:
        self._steps = round(seconds / STEP_S)
        self._pending: deque[tuple[int, float]] = deque()
        self.value = 0.0

    def offer(self, step: int, value: float) -> None:
        """Give a command at ``step``; a later one given at the same step replaces it."""
        due = step + self._steps
        if self._pending and self._pending[-1][0] == due:
            self._pending.pop()
        self._pending.append((due, value))

    def settle(self, step: int, end: int) -> int:
        """Make the command due at ``step`` the value in force; return when that ends."""
        while self._pending and self._pending[0][0] <= step:
            self.value = self._pending.popleft()[1]
        return min(end, self._pending[0][0]) if self._pending else end


class Plant:
    """Position [m], yaw [rad], speed [m/s], tyre angle [rad], acceleration [m/s^2], by steps.

    Source: the plant described with the golden runs, whose states it repeats.
    """

    def __init__(
        self,
        params: PlantParams | None = None,
        *,
        x: float = 0.0,
        y: float = 0.0,
        yaw: float = 0.0,
        speed: float = 0.0,
        gear: int = 1,
    ) -> None:
        self.params = params or PlantParams()
        self.x, self.y, self.yaw, self.speed = x, y, yaw, speed
        self.steering = 0.0
        self.actuated = 0.0  # what drive train (positive) or brakes (negative) give [m/s^2]
        self.acceleration = 0.0  # along body x, slope and standstill included [m/s^2]
        self.gear = gear
        self.steps = 0
        self._angle = DeadTime(self.params.steering_dead_time)
        self._drive = DeadTime(self.params.acceleration_dead_time)

    @property
    def yaw_rate(self) -> float:
        """Yaw rate [rad/s]."""
        return self.speed * math.tan(self.steering) / self.params.wheelbase

    def command(self, angle: float, acceleration: float) -> None:
        """Give a tyre angle [rad] and an acceleration along the gear [m/s^2] to the actuators."""
        self._angle.offer(self.steps, angle)
        self._drive.offer(self.steps, acceleration)

    def advance(self, steps: int, pitch: float = 0.0) -> None:
        """Integrate ``steps`` steps on a slope of ``pitch`` [rad], positive uphill along body x."""
        end = self.steps + steps
        gravity = GRAVITY * math.sin(pitch)
        while self.steps < end:
            until = self._drive.settle(self.steps, self._angle.settle(self.steps, end))
            self._run(until - self.steps, self._angle.value, self._drive.value, gravity)
            self.steps = until

    def _run(self, steps: int, angle: float, drive: float, gravity: float) -> None:
        """Integrate with constant inputs; the heading of a step is that of its middle."""
        x, y, yaw, speed = self.x, self.y, self.yaw, self.speed
        steering, actuated, before = self.steering, self.actuated, self.speed
        steer_gain = STEP_S / self.params.steering_lag
        drive_gain = STEP_S / self.params.acceleration_lag
        turn = 0.5 * STEP_S / self.params.wheelbase
        for _ in range(steps):
            steering += steer_gain * (angle - steering)
            actuated += drive_gain * (drive - actuated)
            before = speed
            speed -= STEP_S * gravity
            push = STEP_S * actuated
            if actuated >= 0.0:
                speed += push * self.gear
            else:
                speed = 0.0 if abs(speed) <= -push else speed + math.copysign(-push, -speed)
            half = turn * speed * math.tan(steering)
            x += STEP_S * speed * math.cos(yaw + half)
            y += STEP_S * speed * math.sin(yaw + half)
            yaw += 2.0 * half
        self.x, self.y, self.yaw, self.speed = x, y, yaw, speed
        self.steering, self.actuated = steering, actuated
        self.acceleration = (speed - before) / STEP_S
