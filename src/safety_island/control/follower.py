# SPDX-License-Identifier: Apache-2.0
"""The trajectory follower: lateral and longitudinal controller over one set of inputs.

This is the thin Python layer around the kernels. Inputs are offered one by one; what is refused
leaves everything as it was. A tick is ``step(now)``; a node that measures the two controllers
calls ``run_lateral``, ``run_longitudinal`` and ``sync`` itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from struct import Struct
from typing import NamedTuple

import numpy as np

from safety_island.control.input_check import (
    MAX_ACCELERATION,
    MAX_POSITION,
    MAX_SPEED,
    MAX_SQUARE_NORM,
    MAX_TURN,
    MIN_SQUARE_NORM,
    UNIT_TOLERANCE,
    check_trajectory,
)
from safety_island.control.lateral import lateral_finish, lateral_prepare, lateral_step
from safety_island.control.lateral_state import new_lateral_state
from safety_island.control.limits import MAX_POINTS
from safety_island.control.longitudinal import longitudinal_step
from safety_island.control.longitudinal_state import (
    new_longitudinal_state,
    new_longitudinal_work,
    reset_longitudinal_trace,
)
from safety_island.control.params import Parameters
from safety_island.control.qp_records import QP
from safety_island.control.records import (
    CLEANED,
    COMMAND,
    INPUTS,
    TRACE,
    new_points,
    pack_parameters,
)
from safety_island.control.status import MpcStatus, Refusal
from safety_island.control.trajectory_clean import clean_trajectory
from safety_island.kernel.records import Records, cells

INPUT_NAMES = ("trajectory", "odometry", "steering", "acceleration", "operation mode")
"""The five inputs without which there is no tick."""

_FEWEST_FOR_MPC = 3
_ACCEPTED = Refusal.ACCEPTED
_MPC_STATUS = {int(status): status for status in MpcStatus}
"""A look here takes a tenth of the time of ``MpcStatus(number)``."""
_POSE_AND_SPEED = Struct("=10d")
"""The first columns of INPUTS, from x to wz."""
_PATH = Struct("=2q2d")
"""The last ones: n_points, trajectory_id, trajectory_stamp."""


def _refusal_of(value: float) -> Refusal:
    """Why a number that is not within its bound is refused."""
    return Refusal.OUT_OF_RANGE if math.isfinite(value) else Refusal.NOT_FINITE


class _Path(NamedTuple):
    """Memory of a trajectory, and the kernels that read it."""

    points: Records
    check: Callable[[int, float], int]
    clean: Callable[[int], int]
    lateral: Callable[[float], int]
    longitudinal: Callable[[float], int]


class TrajectoryFollower:
    """Autoware's MPC and PID controllers, with the memory of all past ticks.

    Fields of a record are written through cells made once: an attribute of a NumPy record costs
    microseconds from Python.

    ``inputs``, ``command`` and ``trace`` are records of shape (1,); ``points`` is the trajectory
    in force. Raises ConfigurationError when the chosen solver is not installed.
    """

    def __init__(self, parameters: Parameters) -> None:
        self.parameters = parameters
        self.inputs: Records = np.zeros(1, INPUTS)
        self.inputs[0].qw = 1.0
        self.command: Records = np.zeros(1, COMMAND)
        self._stamp = self.command["stamp"]
        self.trace: Records = np.zeros(1, TRACE)
        reset_longitudinal_trace(self.trace)
        cell, memory = cells(self.inputs), self.inputs.view(np.uint8).data
        self._steer, self._ax = cell["steer"], cell["ax"]
        self._offset = cell["steering_offset"]
        self._offset_limit = parameters.lateral.steering_offset_input_limit
        self._mode, self._enabled = cell["mode"], cell["enabled"]
        self._write_pose = partial(_POSE_AND_SPEED.pack_into, memory, 0)
        self._write_path = partial(_PATH.pack_into, memory, INPUTS.fields["n_points"][1])
        self._paths = 0
        self._cleaned: Records = np.zeros(1, CLEANED)
        self.turned_points = 0
        """Orientations of the trajectory in force that contradicted it, and were replaced."""
        self._missing = set(INPUT_NAMES)
        self._is_enabled = False
        self._is_allowed = True
        self._has_path = False
        self._params = pack_parameters(parameters)
        self._lateral = new_lateral_state(parameters)
        self._longitudinal = new_longitudinal_state()
        self._work = new_longitudinal_work()
        self._is_converged = cells(self.trace)["is_steer_converged"]
        self._was_converged = cells(self._longitudinal)["is_steer_converged"]
        self._qp: Records = np.zeros(1, QP)
        self._solve = self._external_solver()
        self._now, self._next = self._new_path(), self._new_path()
        """The trajectory in force, and the one that comes after it; they change places."""

    def _new_path(self) -> _Path:
        points, params = new_points(), self._params
        before, after = (params, points, self.inputs), (self.command, self.trace)
        return _Path(
            points,
            check_trajectory.bind(params, points),
            clean_trajectory.bind(params, points, self.inputs, self._cleaned),
            lateral_step.bind(*before, self._lateral, self._qp, *after),
            longitudinal_step.bind(*before, self._longitudinal, self._work, *after),
        )

    @property
    def points(self) -> Records:
        """The trajectory in force."""
        return self._now.points

    @property
    def incoming(self) -> Records:
        """Memory of the next one."""
        return self._next.points

    def _external_solver(self) -> Callable[[Records, int], MpcStatus] | None:
        """The solver that is no kernel, when one is chosen."""
        if self.parameters.lateral.qp_solver_type != "osqp":
            return None
        from safety_island.control.osqp_solver import OsqpSolver

        for kernel in (lateral_prepare, lateral_finish):
            kernel.prepare()
        solver = OsqpSolver(self.parameters.lateral.mpc_prediction_horizon)
        return lambda qp, n: MpcStatus(solver.solve(qp[0]))

    # Inputs: each returns why it was refused, or ACCEPTED.

    def offer_trajectory(self, points: Records, stamp: float, start: float = 0.0) -> Refusal:
        """Offer ``points`` (POINT records) with the stamp [s] of their header; see below."""
        if len(points) > MAX_POINTS:
            return Refusal.TOO_MANY_POINTS
        self.incoming[: len(points)] = points
        return self.offer_incoming(len(points), stamp, start)

    def offer_incoming(self, n: int, stamp: float, start: float = 0.0) -> Refusal:
        """Offer the first ``n`` points of ``incoming``, into which a decoder may write directly.

        ``stamp`` [s] is that of the header, ``start`` [s] the time_from_start of the first point.
        """
        if not math.isfinite(stamp):
            return Refusal.NOT_FINITE
        turned = 0
        if refusal := self._next.check(n, start):
            if refusal == Refusal.NEEDS_CLEANING:
                refusal = self._next.clean(n)
                n, turned = self._cleaned[0].tolist()
            if refusal:
                return Refusal(refusal)
        self._now, self._next = self._next, self._now
        self.turned_points = turned
        self._paths += 1
        self._write_path(n, self._paths, stamp, start)
        self._has_path = self._has_path or n >= _FEWEST_FOR_MPC
        self._missing.discard("trajectory")
        return _ACCEPTED

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
    ) -> Refusal:
        """Offer the ego's pose in the map [m] and its body velocity [m/s, rad/s]."""
        if not (  # NaN is within nothing
            -MAX_POSITION <= x <= MAX_POSITION
            and -MAX_POSITION <= y <= MAX_POSITION
            and -MAX_POSITION <= z <= MAX_POSITION
            and -MAX_SPEED <= vx <= MAX_SPEED
            and -MAX_SPEED <= vy <= MAX_SPEED
            and -MAX_TURN <= wz <= MAX_TURN
        ):
            return _refusal_of(x + y + z + vx + vy + wz)
        square = qx * qx + qy * qy + qz * qz + qw * qw
        if not -UNIT_TOLERANCE <= square - 1.0 <= UNIT_TOLERANCE:
            if not MIN_SQUARE_NORM <= square <= MAX_SQUARE_NORM:
                finite = math.isfinite(qx + qy + qz + qw)
                return Refusal.BAD_QUATERNION if finite else Refusal.NOT_FINITE
            scale = 1.0 / math.sqrt(square)
            qx, qy, qz, qw = qx * scale, qy * scale, qz * scale, qw * scale
        self._write_pose(x, y, z, qx, qy, qz, qw, vx, vy, wz)
        self._missing.discard("odometry")
        return _ACCEPTED

    def offer_steering(self, angle: float) -> Refusal:
        """Offer the measured tyre angle [rad]."""
        if not abs(angle) <= MAX_TURN:
            return _refusal_of(angle)
        self._steer[0] = angle
        self._missing.discard("steering")
        return _ACCEPTED

    def offer_acceleration(self, ax: float) -> Refusal:
        """Offer the measured acceleration along body x [m/s^2]."""
        if not abs(ax) <= MAX_ACCELERATION:
            return _refusal_of(ax)
        self._ax[0] = ax
        self._missing.discard("acceleration")
        return _ACCEPTED

    def offer_steering_offset(self, offset: float) -> Refusal:
        """Offer the offset of the steering sensor [rad]; no tick waits for one."""
        if not abs(offset) <= self._offset_limit:
            return _refusal_of(offset)
        self._offset[0] = offset
        return _ACCEPTED

    def offer_operation_mode(self, mode: int, enabled: bool) -> Refusal:
        """Offer the operation mode and whether Autoware's control is enabled."""
        if not 0 <= mode <= 255:
            return Refusal.OUT_OF_RANGE
        self._mode[0] = mode
        self._is_enabled = enabled
        self._enabled[0] = enabled and self._is_allowed
        self._missing.discard("operation mode")
        return _ACCEPTED

    def allow_control(self, allowed: bool) -> None:
        """Say whether commands are followed; if not, the controllers run as in manual mode."""
        if allowed is not self._is_allowed:
            self._is_allowed = allowed
            self._enabled[0] = self._is_enabled and allowed

    def missing(self) -> tuple[str, ...]:
        """Names of the inputs that were never accepted, in the order of INPUT_NAMES."""
        return tuple(name for name in INPUT_NAMES if name in self._missing)

    def is_ready(self) -> bool:
        """Whether both controllers can run: every input is there, and a path of three points."""
        return not self._missing and self._has_path

    # A tick.

    def run_lateral(self, now: float) -> MpcStatus:
        """Run the lateral controller at ``now`` [s]; NO_REFERENCE leaves the command alone."""
        if self._solve is None:
            return _MPC_STATUS[self._now.lateral(now)]
        return self._run_lateral_in_parts(self._solve, now)

    def _run_lateral_in_parts(
        self, solve: Callable[[Records, int], MpcStatus], now: float
    ) -> MpcStatus:
        """Run the lateral controller around a solver that is no kernel."""
        before = (self._params, self.points, self.inputs, self._lateral, self._qp)
        status = lateral_prepare.call(*before, self.trace, now)
        if status == MpcStatus.SOLVED:
            status = solve(self._qp, self.parameters.lateral.mpc_prediction_horizon)
        if status != MpcStatus.NO_REFERENCE:
            lateral_finish.call(*before, self.command, self.trace, now, int(status))
        return MpcStatus(status)

    def run_longitudinal(self, now: float) -> int:
        """Run the longitudinal controller at ``now`` [s]; a LongitudinalState, or a skip (< 0)."""
        return self._now.longitudinal(now)

    def sync(self) -> None:
        """Hand each controller what the other needs in the next tick."""
        self._was_converged[0] = self._is_converged[0]

    def step(self, now: float) -> bool:
        """Run one whole tick at ``now`` [s]; returns whether ``command`` is a new command."""
        if not self.is_ready() or self.run_lateral(now) is MpcStatus.NO_REFERENCE:
            return False
        if self.run_longitudinal(now) < 0:
            return False
        self._stamp[0] = now
        self.sync()
        return True
