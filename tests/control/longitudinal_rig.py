# SPDX-License-Identifier: Apache-2.0
"""A longitudinal controller on a straight road, for tests that set one thing at a time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from safety_island.control.longitudinal import longitudinal_step
from safety_island.control.longitudinal_state import (
    new_longitudinal_state,
    new_longitudinal_work,
    reset_longitudinal_trace,
)
from safety_island.control.records import COMMAND, INPUTS, TRACE, new_points, pack_parameters
from safety_island.control.status import LongitudinalState
from safety_island.kernel.records import Records
from tests.golden.harness import firmware

PERIOD = 0.15
START = 1000.0


def packed(**overrides: Any) -> Records:
    """The firmware's parameters with some of them changed, as a PARAMS record."""
    return pack_parameters(firmware(**({"ctrl_period": PERIOD} | overrides)))


class Rig:
    """Holds every argument of the step; ``tick`` changes some inputs and makes one tick."""

    def __init__(self, **overrides: Any) -> None:
        longitudinal_step.prepare()
        self.params = packed(**overrides)
        self.points = new_points()
        self.inputs: Records = np.zeros(1, INPUTS)
        self.state = new_longitudinal_state()
        self.work = new_longitudinal_work()
        self.command: Records = np.zeros(1, COMMAND)
        self.trace: Records = np.zeros(1, TRACE)
        reset_longitudinal_trace(self.trace)
        self.now = START - PERIOD
        self.status = 0
        self.inputs[0].mode = 2
        self.inputs[0].enabled = True
        self.turn(0.0)

    def turn(self, yaw: float = 0.0, pitch: float = 0.0) -> None:
        """Set the ego's orientation; ``pitch`` is positive uphill, so about minus body y."""
        self.inputs[0].qx = math.sin(yaw / 2) * math.sin(pitch / 2)
        self.inputs[0].qy = -math.cos(yaw / 2) * math.sin(pitch / 2)
        self.inputs[0].qz = math.sin(yaw / 2) * math.cos(pitch / 2)
        self.inputs[0].qw = math.cos(yaw / 2) * math.cos(pitch / 2)

    def road(self, x: Any, v: Any, acc: Any = 0.0, z: Any = 0.0) -> None:
        """Put a road along x in force, heading toward +x; values per point or for all."""
        n = len(x)
        self.points[:n] = np.zeros((), self.points.dtype)
        for name, value in (("x", x), ("v", v), ("acc", acc), ("z", z), ("qw", 1.0)):
            self.points[name][:n] = value
        self.inputs[0].n_points = n
        self.inputs[0].trajectory_id += 1

    def tick(self, dt: float = PERIOD, **inputs: float) -> Any:
        """Make one tick ``dt`` [s] after the previous one; return the trace."""
        for name, value in inputs.items():
            self.inputs[0][name] = value
        self.now += dt
        self.status = longitudinal_step.call(
            self.params,
            self.points,
            self.inputs,
            self.state,
            self.work,
            self.command,
            self.trace,
            self.now,
        )
        return self.trace[0]

    @property
    def s(self) -> Any:
        """The state record."""
        return self.state[0]

    @property
    def velocity(self) -> float:
        """The commanded speed [m/s]."""
        return float(self.command[0].velocity)

    @property
    def acceleration(self) -> float:
        """The commanded acceleration [m/s^2]."""
        return float(self.command[0].acceleration)


def cruise(v: float = 1.0, **overrides: Any) -> Rig:
    """A rig on a 100 m road at one speed, with no wait for the steering."""
    rig = Rig(**({"enable_keep_stopped_until_steer_convergence": False} | overrides))
    rig.road([0.0, 50.0, 100.0], v)
    return rig


def rig_in(state: LongitudinalState, **overrides: Any) -> Rig:
    """A rig in a state, on a 20 m road at 2 m/s with a stop point at 10 m."""
    rig = Rig(**overrides)
    x = [0.5 * i for i in range(41)]
    rig.road(x, [0.0 if each >= 10.0 else 2.0 for each in x])
    rig.s.state = state
    return rig
