# SPDX-License-Identifier: Apache-2.0
"""Record types that the kernels share: parameters, one trajectory point, inputs, command, trace.

Each is C-aligned and is what a firmware header declares later. A kernel takes a record as an array
of shape (1,) and indexes it inside.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np

from safety_island.control.limits import MAX_HORIZON, MAX_POINTS, MAX_RATE_TABLE
from safety_island.control.params import (
    LateralParams,
    LongitudinalParams,
    NodeParams,
    Parameters,
    VehicleParams,
)
from safety_island.control.release import Rules, rules_of
from safety_island.control.status import ReferenceMode, SlopeSource, Solver, VehicleModel
from safety_island.kernel.records import Records, record

_CHOICES: dict[str, Any] = {
    "slope_source": SlopeSource,
    "trajectory_reference_mode": ReferenceMode,
    "qp_solver_type": Solver,
    "vehicle_model_type": VehicleModel,
}
_SCALARS = {"float": "f8", "int": "i8", "bool": "?"}
_GROUPS = (VehicleParams, NodeParams, LateralParams, LongitudinalParams, Rules)


def _parameter_columns() -> list[Any]:
    columns: list[Any] = []
    for group in _GROUPS:
        for item in fields(group):
            kind = str(item.type)
            if kind in _SCALARS:
                columns.append((item.name, _SCALARS[kind]))
            elif item.name in _CHOICES:
                columns.append((item.name, "i4"))
            elif kind.startswith("tuple"):
                columns += [(item.name, "f8", (MAX_RATE_TABLE,)), (f"{item.name}_size", "i8")]
    return columns


PARAMS = record(_parameter_columns())
"""Every parameter and every rule by its name; a choice is its number, a table has a ``_size``."""


def pack_parameters(parameters: Parameters) -> Records:
    """Return the (1,) record of a parameter set.

    Raises ValueError when a table is longer than MAX_RATE_TABLE.
    """
    packed = np.zeros(1, PARAMS)
    groups = (parameters.vehicle, parameters.node, parameters.lateral, parameters.longitudinal)
    for group in (*groups, _rules(parameters)):
        for item in fields(group):
            value = getattr(group, item.name)
            if isinstance(value, tuple):
                packed[0][item.name][: len(value)] = value
                packed[0][f"{item.name}_size"] = len(value)
            elif item.name in _CHOICES:
                packed[0][item.name] = _CHOICES[item.name][value.upper()]
            elif not isinstance(value, str):
                packed[0][item.name] = value
    return packed


def _rules(parameters: Parameters) -> Rules:
    """Return the rules in force: those of the release, and the signs that ours corrects."""
    rules = rules_of(parameters.node.autoware_release)
    if not parameters.longitudinal.correct_reverse_signs:
        return rules
    return replace(rules, feedback_turns_in_reverse=True, slope_turns_in_reverse=True)


POINT = record(
    [
        ("x", "f8"),  # position [m]
        ("y", "f8"),
        ("z", "f8"),
        ("qx", "f8"),  # orientation
        ("qy", "f8"),
        ("qz", "f8"),
        ("qw", "f8"),
        ("v", "f4"),  # longitudinal_velocity_mps [m/s]
        ("v_lat", "f4"),  # lateral_velocity_mps [m/s]
        ("acc", "f4"),  # acceleration_mps2 [m/s^2]
        ("heading_rate", "f4"),  # heading_rate_rps [rad/s]
        ("front_wheel", "f4"),  # front_wheel_angle_rad [rad]
        ("rear_wheel", "f4"),  # rear_wheel_angle_rad [rad]
        ("sec", "i4"),  # on the wire: time_from_start of the *next* point
        ("nanosec", "u4"),
    ]
)
"""One trajectory point, 88 bytes, laid out as on the wire from the first ``position.x`` on."""

CLEANED = record(
    [
        ("n", "i8"),  # points that are left
        ("turned", "i8"),  # orientations that were replaced
    ]
)
"""What cleaning has made of a trajectory."""

INPUTS = record(
    [
        ("x", "f8"),  # ego position in the map [m]
        ("y", "f8"),
        ("z", "f8"),
        ("qx", "f8"),  # ego orientation, unit quaternion
        ("qy", "f8"),
        ("qz", "f8"),
        ("qw", "f8"),
        ("vx", "f8"),  # speed along body x [m/s]
        ("vy", "f8"),  # speed along body y [m/s]
        ("wz", "f8"),  # yaw rate [rad/s]
        ("ax", "f8"),  # acceleration along body x [m/s^2]
        ("steering_offset", "f8"),  # of the steering sensor, as a topic tells it [rad]
        ("steer", "f4"),  # measured tyre angle [rad]
        ("mode", "i4"),  # operation mode, see Mode
        ("enabled", "?"),  # is_autoware_control_enabled
        ("n_points", "i8"),  # points of the trajectory in force
        ("trajectory_id", "i8"),  # counts received trajectories; 0: none yet
        ("trajectory_stamp", "f8"),  # its header stamp [s]
        ("trajectory_start", "f8"),  # time_from_start of its first point [s]
    ]
)
"""Everything that one tick reads, besides the points of the trajectory."""

COMMAND = record(
    [
        ("stamp", "f8"),  # of the command and of its lateral part [s]
        ("longitudinal_stamp", "f8"),  # [s]
        ("steering_tire_angle", "f4"),  # [rad]
        ("steering_tire_rotation_rate", "f4"),  # [rad/s]
        ("velocity", "f4"),  # [m/s]
        ("acceleration", "f4"),  # [m/s^2]
        ("is_defined_steering_tire_rotation_rate", "?"),
    ]
)
"""One control command."""

TRACE = record(
    [
        # what the status tells in every tick, in its order, so that it is read in one stroke
        ("lateral_error", "f8"),  # [m]
        ("yaw_error", "f8"),  # [rad]
        ("residual", "f8"),  # of the optimality conditions
        ("stop_dist", "f8"),  # [m]
        ("target_vel", "f8"),  # [m/s]
        ("solver_status", "i4"),
        ("solver_iterations", "i4"),
        ("active_constraints", "i4"),
        ("lon_state", "i4"),  # LongitudinalState
        ("mpc_status", "i4"),  # MpcStatus
        # the limits that acted, in the order of ControllerLimit
        ("angle_limited", "?"),  # the clamp to max_steer_angle acted
        ("rate_limited", "?"),  # a steering-rate constraint was active
        ("stopped", "?"),  # the lateral wrapper held the previous command
        ("acc_limited", "?"),  # min_acc or max_acc acted
        ("jerk_limited", "?"),
        ("diff_limited", "?"),  # max_acc_cmd_diff acted
        ("pitch_limited", "?"),
        ("slow_start_held", "?"),  # kept stopped until the steering has converged
        ("brake_keeping", "?"),
        ("far_from_trajectory", "?"),
        ("stuck_in_emergency", "?"),  # far from the trajectory: only coming near again ends it
        # lateral
        ("lateral_ready", "?"),
        ("is_steer_converged", "?"),  # the value that goes to the PID for the next tick
        ("mpc_history_filled", "?"),
        ("shape_changed", "?"),
        ("is_forward_shift", "?"),
        ("under_control", "?"),
        ("raw_steer_cmd_prev", "f8"),  # [rad]
        ("raw_steer_cmd_pprev", "f8"),
        ("nearest_idx", "i8"),  # of the resampled reference
        ("nearest_time", "f8"),  # [s] on the reference's own clock
        ("prediction_dt", "f8"),  # [s]
        ("predicted_steer", "f8"),  # [rad]
        ("steering_offset", "f8"),  # [rad]
        ("u", "f8", (MAX_HORIZON,)),  # raw solution [rad]
        # longitudinal
        ("target_acc", "f8"),  # [m/s^2]
        ("nearest_vel", "f8"),  # [m/s]
        ("pred_vel", "f8"),  # [m/s]
        ("slope_angle", "f8"),  # [rad]
        ("err_vel_filtered", "f8"),  # [m/s]
        ("pid_p", "f8"),  # [m/s^2]
        ("pid_i", "f8"),
        ("pid_d", "f8"),
        ("ff_scale", "f8"),
        ("acc_ff", "f8"),  # [m/s^2]
        ("acc_pid_applied", "f8"),
        ("acc_acc_limited", "f8"),
        ("acc_jerk_limited", "f8"),
        ("acc_fb_applied", "f8"),
        ("acc_slope_applied", "f8"),
        ("trans_dev", "f8"),  # [m]
        ("rot_dev", "f8"),  # [rad]
        ("prev_raw_acc", "f8"),  # memories after the tick
        ("prev_raw_vel", "f8"),
        ("prev_acc", "f8"),
        ("smooth_stop_mode", "i4"),  # SmoothStopMode
        ("gear_forward", "?"),
    ]
)
"""What one tick did and why; a value keeps its old content where the tick did not set it."""


def new_points() -> Records:
    """Return memory for one trajectory of up to MAX_POINTS points."""
    return np.zeros(MAX_POINTS, POINT)
