# SPDX-License-Identifier: Apache-2.0
"""The declared stop of CAN_ONLY: brake with a bounded jerk, hold at standstill, then silence."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.life_cycle.params import LifeCycleParams


class Motion(NamedTuple):
    """A command: tyre angle [rad], its rate [rad/s], speed [m/s], acceleration [m/s^2]."""

    angle: float
    rate: float
    velocity: float
    acceleration: float


class StopRamp:
    """Leads the last command to a standstill, tick by tick; it needs no measurement.

    The speed follows from the commanded acceleration, in the direction in which the vehicle went.
    ``is_over`` when the stopped vehicle was held for the time of the parameters.
    """

    def __init__(self, params: LifeCycleParams, last: Motion, speed: float) -> None:
        """``speed``: the last measured speed [m/s], which the ramp starts from."""
        self.is_over = False
        self._params = params
        self._gear = -1.0 if speed < 0.0 or (speed == 0.0 and last.velocity < 0.0) else 1.0
        self._speed = abs(speed)
        self._acceleration = min(last.acceleration, 0.0)
        self._angle = last.angle
        self._held_s = 0.0

    def step(self, dt: float) -> Motion:
        """Return the command ``dt`` [s] later."""
        params = self._params
        target = -params.stop_deceleration
        step = params.stop_jerk * dt
        change = min(step, max(-step, target - self._acceleration))
        self._acceleration += change
        if self._speed == 0.0:
            self._held_s += dt
            self.is_over = self._held_s >= params.stop_hold
        self._speed = max(0.0, self._speed + self._acceleration * dt)
        rate = self._steer(dt)
        return Motion(self._angle, rate, self._gear * self._speed, self._acceleration)

    def _steer(self, dt: float) -> float:
        """Hold the angle or lead it to the centre; return the rate [rad/s]."""
        if self._params.stop_steering == "hold":
            return 0.0
        most = self._params.stop_steering_rate * dt
        change = min(most, max(-most, -self._angle))
        self._angle += change
        return change / dt
