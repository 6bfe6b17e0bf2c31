# SPDX-License-Identifier: Apache-2.0
"""What the MPC of the last tick foresees: its reference, its commands and the path they lead to.

Autoware: calculatePredictedTrajectoryInWorldCoordinate, clipTrajectoryByLength (mpc.cpp and its
vehicle models).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from safety_island.control.geometry import clip, normalize_angle
from safety_island.control.reference_shape import yaw_at
from safety_island.control.release import RELEASES
from safety_island.control.status import VehicleModel
from safety_island.kernel.cdr import NANOSECONDS
from safety_island.messages.points import POINT, Points
from safety_island.node.debug.follower import ObservedFollower

Column = npt.NDArray[np.float64]
_DIVIDES_BY_STEP = RELEASES.index("0.53")
_TELLS_TIMES = RELEASES.index("0.47")
_TELLS_WHEELS = RELEASES.index("0.48")


class Stations(NamedTuple):
    """The reference at the N stations of the horizon, each of shape (N,)."""

    x: Column
    """[m]"""
    y: Column
    z: Column
    yaw: Column
    """[rad]"""


class Horizon:
    """Reads the horizon of the last tick in which the MPC found a solution."""

    def __init__(self, follower: ObservedFollower) -> None:
        self._follower = follower
        parameters = follower.parameters
        self._release = RELEASES.index(parameters.node.autoware_release)
        self._count = parameters.lateral.mpc_prediction_horizon
        self._wheel_base = parameters.vehicle.wheel_base
        self._limit = parameters.vehicle.max_steer_angle
        self._period = parameters.node.ctrl_period
        self._model = VehicleModel(int(follower.params.vehicle_model_type))
        yaw_at(follower.lateral, 0)  # compiled now, not in the first tick

    @property
    def step_s(self) -> float:
        """Time from one station to the next [s]."""
        return float(self._follower.lateral.prediction_dt)

    def commands(self) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
        """Return angles [rad] and rates [rad/s] of the horizon, shape (N,) each.

        The first is the command before the offset of the sensor is taken off, also while the
        steering is held. A rate is the change over the step; until 0.52 over the control period.
        """
        lat, raw = self._follower.lateral, self._follower.trace[0].u[: self._count]
        angles = np.clip(raw, -self._limit, self._limit).astype(np.float32)
        angles[0] = lat.predictor_u[lat.predictor_n - 1]
        step = self.step_s if self._release >= _DIVIDES_BY_STEP else self._period
        rates = np.diff(angles, prepend=angles[:1]).astype(np.float64) / step
        rates[0] = self._first_rate(float(angles[0]))
        return angles, rates.astype(np.float32)

    def _first_rate(self, angle: float) -> float:
        lat = self._follower.lateral
        if self._model is VehicleModel.KINEMATICS:
            return float(lat.x_next[2] - lat.x0_delayed[2]) / self.step_s
        return (angle - float(lat.measured)) / self.step_s

    def times(self) -> Column:
        """Return when each station is due [s], on the clock of the reference."""
        lat = self._follower.lateral
        start = lat.nearest_time + lat.delay_n * self._period
        return np.asarray(start + np.arange(self._count) * lat.prediction_dt)

    def stations(self) -> Stations:
        """Return the reference at the stations; the yaw alone takes a call for each point."""
        lat, times = self._follower.lateral, self.times()
        # The closing duplicates stand on the last point.
        points = np.minimum(lat.segment + np.arange(lat.window), lat.ref_n - 1)
        due = lat.wt[: lat.window]
        x, y, z = (np.interp(times, due, column[points]) for column in (lat.rx, lat.ry, lat.rz))
        whole = self._model is VehicleModel.DYNAMICS
        yaw = [self._yaw(t, due) for t in (times if whole else times[:1])]
        return Stations(x, y, z, np.array(yaw))

    def _yaw(self, time: float, due: Column) -> float:
        """Yaw [rad] of the reference at a time, on the shorter way between its neighbours."""
        lat = self._follower.lateral
        w = int(clip(np.searchsorted(due, time, "left") - 1, 0, len(due) - 2))
        part = clip((time - due[w]) / (due[w + 1] - due[w]), 0.0, 1.0)
        first = float(yaw_at(lat, int(lat.segment) + w))
        turn = normalize_angle(float(yaw_at(lat, int(lat.segment) + w + 1)) - first)
        return float(first + part * turn)

    def predicted(self) -> Points:
        """Return the path that the commands lead to, no longer than the reference: POINT records.

        Kinematic models are followed in the world, where the error dynamics' linearisation does
        not count; the dynamic one relative to the reference.
        """
        reference = self.stations()
        is_dynamic = self._model is VehicleModel.DYNAMICS
        rows = self._beside(reference) if is_dynamic else self._through_the_world(reference)
        return self._points(reference, np.array(rows))

    def _through_the_world(self, reference: Stations) -> list[tuple[float, float, float]]:
        """Return x, y [m] and yaw [rad] of every step of the bicycle, by Euler's method.

        As in Autoware, the wheels are taken to follow each command at once.
        """
        lat, dt = self._follower.lateral, self.step_s
        lateral, heading = (float(value) for value in lat.x0_delayed[:2])
        yaw = float(reference.yaw[0])
        x = float(reference.x[0]) - math.sin(yaw) * lateral
        y = float(reference.y[0]) + math.cos(yaw) * lateral
        yaw += heading
        rows = []
        speeds, inputs = lat.hv[: self._count].tolist(), self._follower.trace[0].u.tolist()
        for v, u in zip(speeds, inputs, strict=False):
            x, y = x + v * math.cos(yaw) * dt, y + v * math.sin(yaw) * dt
            yaw += v * math.tan(u) / self._wheel_base * dt
            rows.append((x, y, yaw))
        return rows

    def _beside(self, reference: Stations) -> list[tuple[float, float, float]]:
        """Return x, y [m] and yaw [rad] of every step of the error dynamics."""
        lat, state = self._follower.lateral, np.array(self._follower.lateral.x0_delayed)
        rows = []
        for i in range(self._count):
            state = lat.A[i] @ state + lat.B[i] * self._follower.trace[0].u[i] + lat.W[i]
            yaw = float(reference.yaw[i])
            x = float(reference.x[i]) - math.sin(yaw) * state[0]
            y = float(reference.y[i]) + math.cos(yaw) * state[0]
            rows.append((x, y, yaw + float(state[2])))
        return rows

    def _points(self, reference: Stations, rows: Column) -> Points:
        lat = self._follower.lateral
        x, y, yaw = rows.T
        points: Any = np.zeros(self._count, POINT)
        points["x"], points["y"], points["z"] = x, y, reference.z
        points["qz"], points["qw"] = np.sin(yaw / 2.0), np.cos(yaw / 2.0)
        points["v"] = lat.hv[: self._count]
        if self._release >= _TELLS_WHEELS:
            points["front_wheel"] = np.arctan(lat.hks[: self._count] * self._wheel_base)
        if self._release >= _TELLS_TIMES:
            times = self.times()
            due = ((times - times[0]) * NANOSECONDS).astype(np.int64)
            # A record holds the time of the point behind it.
            points["sec"][:-1], points["nanosec"][:-1] = np.divmod(due[1:], NANOSECONDS)
        found: Points = points[: self._fitting(reference, points)]
        return found

    def _fitting(self, reference: Stations, points: Points) -> int:
        """Return how many points are no farther along than the reference is long."""
        length = np.hypot(np.diff(reference.x), np.diff(reference.y)).sum()
        steps = [np.diff(points[name]) for name in ("x", "y", "z")]
        along = np.cumsum(np.sqrt(sum(step * step for step in steps)))
        return 1 + int(np.searchsorted(along, length, "right"))
