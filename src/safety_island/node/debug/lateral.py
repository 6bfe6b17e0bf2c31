# SPDX-License-Identifier: Apache-2.0
"""The numbers of the topic lateral_diagnostic. Autoware: MPC::generateDiagData."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from safety_island.control.geometry import normalize_angle, yaw_of
from safety_island.control.reference_shape import curvature_at
from safety_island.control.reference_temporal import reference_time
from safety_island.control.release import RELEASES
from safety_island.node.debug.follower import ObservedFollower

_TELLS_TEMPORAL = RELEASES.index("0.53")
TEMPORAL_COUNT = 6
"""Numbers of the temporal mode, NaN in the spatial one."""


def temporal_values(time: float | None) -> list[float]:
    """Return predicted, observed and fused time [s], whether the observed one counts, its window.

    Nothing observes the time, neither in Autoware nor here. ``time`` is None in the spatial mode.
    """
    if time is None:
        return [math.nan] * TEMPORAL_COUNT
    return [time, math.nan, time, 0.0, math.nan, math.nan]


class LateralNumbers:
    """Reads what the MPC of the last tick worked with."""

    def __init__(self, follower: ObservedFollower) -> None:
        self._follower = follower
        parameters = follower.parameters
        self._release = RELEASES.index(parameters.node.autoware_release)
        self._wheel_base = parameters.vehicle.wheel_base
        self._count = parameters.lateral.mpc_prediction_horizon
        self._reaches = (
            parameters.lateral.curvature_smoothing_num_traj,
            parameters.lateral.curvature_smoothing_num_ref_steer,
        )
        self._is_unconstrained = parameters.lateral.qp_solver_type == "unconstraint_fast"
        self.path_curvatures()  # compiled now, not in the first tick

    def path_curvatures(self) -> tuple[float, float]:
        """Curvature [1/m] of the nearest reference point, plain and for the feed-forward."""
        lat, nearest = self._follower.lateral, int(self._follower.trace[0].nearest_idx)
        plain, smooth = (float(curvature_at(lat, nearest, reach)) for reach in self._reaches)
        return plain, smooth

    def read(self, angle: float, now: float) -> npt.NDArray[np.float32]:
        """Return the numbers; ``angle`` [rad] is the MPC's command, ``now`` [s] the tick's time."""
        lat, trace, inputs = (
            self._follower.lateral,
            self._follower.trace[0],
            self._follower.inputs[0],
        )
        plain, smooth = self.path_curvatures()
        yaw = float(yaw_of(inputs.qx, inputs.qy, inputs.qz, inputs.qw))
        speed = float(inputs.vx)
        values = [
            angle,
            trace.u[0],
            lat.u_ref[0],
            math.atan(smooth * self._wheel_base),
            lat.measured,
            trace.lateral_error,
            yaw,
            float(normalize_angle(yaw - float(trace.yaw_error))),
            trace.yaw_error,
            lat.wv[int(trace.nearest_idx) - int(lat.segment)],
            speed,
            self._turn(speed, angle),
            self._turn(speed, float(lat.measured)),
            speed * smooth,
            smooth,
            plain,
            trace.predicted_steer,
            self._turn(speed, float(trace.predicted_steer)),
            *self._solver(),
        ]
        if self._release >= _TELLS_TEMPORAL:
            time = float(reference_time(lat, inputs, now)) if lat.is_timed else None
            values += temporal_values(time)
        return np.array(values, np.float32)

    def _turn(self, speed: float, angle: float) -> float:
        """Yaw rate [rad/s] of the bicycle."""
        return speed * math.tan(angle) / self._wheel_base

    def _solver(self) -> tuple[float, float, float]:
        """Iterations, duration [s] and value of the objective; all 0 without constraints.

        The island does not time the solver alone: NaN.
        """
        if self._is_unconstrained:
            return 0.0, 0.0, 0.0
        problem, trace = self._follower.problem, self._follower.trace[0]
        n = self._count
        u = trace.u[:n]
        value = 0.5 * u @ problem.H[:n, :n] @ u + problem.f[:n] @ u
        return float(trace.solver_iterations), math.nan, float(value)
