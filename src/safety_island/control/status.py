# SPDX-License-Identifier: Apache-2.0
"""Names of every state and reason that the kernels return as a number."""

from enum import IntEnum, IntFlag


class Mode(IntEnum):
    """``OperationModeState.mode``."""

    UNKNOWN = 0
    STOP = 1
    AUTONOMOUS = 2
    LOCAL = 3
    REMOTE = 4


class LongitudinalState(IntEnum):
    """States of the longitudinal controller, with the firmware's numbers."""

    DRIVE = 0
    STOPPING = 1
    STOPPED = 2
    EMERGENCY = 3


class LongitudinalSkip(IntEnum):
    """Why a longitudinal tick gave no command and left its state as it was."""

    NO_TRAJECTORY = -1
    NOT_USABLE = -2


class SmoothStopMode(IntEnum):
    """How hard the smooth stop brakes, with the firmware's numbers; NONE outside STOPPING."""

    NONE = -1
    STRONG = 0
    WEAK = 1
    WEAK_STOP = 2
    STRONG_STOP = 3


class SlopeSource(IntEnum):
    """Where the slope compensation takes the pitch from."""

    RAW_PITCH = 0
    TRAJECTORY_PITCH = 1
    TRAJECTORY_ADAPTIVE = 2
    TRAJECTORY_GOAL_ADAPTIVE = 3


class ReferenceMode(IntEnum):
    """How the reference point of a tick is chosen."""

    SPATIAL = 0
    TEMPORAL = 1


class VehicleModel(IntEnum):
    """Prediction models of the MPC."""

    KINEMATICS = 0
    KINEMATICS_NO_DELAY = 1
    DYNAMICS = 2


class Solver(IntEnum):
    """Quadratic-programme solvers of the MPC."""

    UNCONSTRAINT_FAST = 0
    OSQP = 1
    DAQP = 2


class Refusal(IntEnum):
    """Why an input was refused before it could touch the controller."""

    ACCEPTED = 0
    NOT_FINITE = 1
    TOO_FEW_POINTS = 2
    TOO_MANY_POINTS = 3
    COINCIDENT_POINTS = 4
    BAD_QUATERNION = 5
    TOO_LONG = 6
    OUT_OF_RANGE = 7
    MIXED_DIRECTION = 8
    BAD_TIMES = 9
    NEEDS_CLEANING = 10
    """Of a check alone: cleaning decides."""


class MpcStatus(IntEnum):
    """Why the MPC did or did not give a command."""

    SOLVED = 0
    NO_REFERENCE = 1
    TOO_FAR = 2
    YAW_ERROR_TOO_LARGE = 3
    TRAJECTORY_TOO_SHORT = 4
    INVALID_MATRIX = 5
    NOT_POSITIVE_DEFINITE = 6
    INFEASIBLE = 7
    ITERATION_LIMIT = 8
    SOLUTION_NOT_FINITE = 9
    SOLUTION_VIOLATES = 10
    SOLUTION_NOT_OPTIMAL = 11
    SOLVER_ERROR = 12


class ControllerLimit(IntFlag):
    """What bounded or held a command in a tick, for the status: one bit for each flag of TRACE."""

    STEERING_ANGLE = 1
    """The tyre angle was clamped to ``max_steer_angle``."""
    STEERING_RATE = 2
    """A steering-rate constraint was active."""
    STEERING_HELD = 4
    """The vehicle stands, so the last steering command was held."""
    ACCELERATION = 8
    """``min_acc`` or ``max_acc`` acted."""
    JERK = 16
    """``min_jerk`` or ``max_jerk`` acted."""
    COMMAND_DIFFERENCE = 32
    """``max_acc_cmd_diff`` acted."""
    PITCH = 64
    """The pitch of the slope compensation was clamped."""
    SLOW_START = 128
    """The start was held back until the steering has converged."""
    BRAKE_KEEPING = 256
    """A light brake was kept up to the stop point."""
    FAR_FROM_TRAJECTORY = 512
    """The vehicle is farther from the trajectory than the longitudinal controller follows."""
    STUCK_IN_EMERGENCY = 1024
    """The emergency stop lasts until the vehicle is near the trajectory again."""
