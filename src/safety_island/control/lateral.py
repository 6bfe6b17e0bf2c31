# SPDX-License-Identifier: Apache-2.0
"""The lateral controller around the MPC: history, stopped state, convergence."""

import numpy as np

from safety_island.control.condense import condense
from safety_island.control.convergence import (
    has_shape_changed,
    is_mpc_converged,
    is_steer_converged,
    remember_command,
    remember_end,
)
from safety_island.control.geometry import clip, yaw_of
from safety_island.control.lateral_state import LATERAL_STATE
from safety_island.control.mpc import finish_mpc, prepare_mpc
from safety_island.control.points import distance_2d, nearest_index
from safety_island.control.qp_records import QP
from safety_island.control.records import COMMAND, INPUTS, PARAMS, POINT, TRACE
from safety_island.control.reference import accept_source, update_reference
from safety_island.control.reference_temporal import accept_timed
from safety_island.control.solver import solve, tell_solver
from safety_island.control.status import Mode, MpcStatus, ReferenceMode
from safety_island.control.steering_offset import follow_offset, update_offset
from safety_island.kernel.kernel import entry, kernel

_SOLVED = int(MpcStatus.SOLVED)
_INVALID_MATRIX = int(MpcStatus.INVALID_MATRIX)
_NO_REFERENCE = int(MpcStatus.NO_REFERENCE)
_AUTONOMOUS = int(Mode.AUTONOMOUS)
_TEMPORAL = int(ReferenceMode.TEMPORAL)
_FEWEST_POINTS = 3


@kernel
def _set_trajectory(params, points, inputs, lat):
    """Take the trajectory in force as the reference, or keep the old one when it is too short."""
    if inputs.n_points < _FEWEST_POINTS:
        return
    is_timed = params.trajectory_reference_mode == _TEMPORAL
    if lat.source_id != inputs.trajectory_id:
        if is_timed:
            accept_timed(params, points, inputs, lat)
        else:
            accept_source(params, points, inputs.n_points, lat)
        lat.source_id = inputs.trajectory_id
        last = points[inputs.n_points - 1]
        remember_end(params, lat, last.x, last.y, inputs.trajectory_stamp)
    if not is_timed:
        update_reference(params, points, inputs, lat)


@kernel
def _measure(params, inputs, lat):
    """Note the measured angle without the sensor's offset, and who is in control."""
    lat.measured = inputs.steer
    if params.steering_offset_is_input:
        follow_offset(params, lat, inputs.steering_offset)
        lat.measured = np.float32(inputs.steer + np.float32(lat.offset))
    elif params.steering_offset_enable_auto_steering_offset_removal:
        lat.measured = np.float32(inputs.steer - lat.offset)
    lat.is_under_control = inputs.enabled and inputs.mode == _AUTONOMOUS
    if not lat.cmd_prev_valid or not lat.is_under_control:
        lat.cmd_prev_angle = lat.measured
        lat.cmd_prev_rate = np.float32(0.0)
        lat.cmd_prev_valid = True


@kernel
def _prepare(params, points, inputs, lat, qp, trace, now):
    """Take this tick's inputs and set up the problem."""
    _set_trajectory(params, points, inputs, lat)
    trace.lateral_ready = lat.ref_n > 0
    if lat.ref_n == 0:
        trace.mpc_status = _NO_REFERENCE
        return _NO_REFERENCE
    _measure(params, inputs, lat)
    return prepare_mpc(params, inputs, lat, qp, trace, now)


@kernel
def _slowest_ahead(points, n, start, look_ahead):
    """Lowest signed speed [m/s] from point ``start`` to the first one beyond ``look_ahead`` [m].

    In reverse the lowest is the fastest, so looking ahead acts in forward driving only.
    Autoware: MpcLateralController::isStoppedState.
    """
    slowest = points[start].v
    distance = 0.0
    i = start + 1
    while i < n and distance <= look_ahead and look_ahead > 0.0:
        distance += distance_2d(points[i - 1], points[i])
        slowest = min(slowest, points[i].v)
        i += 1
    return slowest


@kernel
def _is_stopped(params, points, inputs, lat):
    """Whether vehicle and trajectory stand still and the steering has come to rest."""
    speed = abs(inputs.vx)
    limit = params.stop_state_entry_ego_speed
    if speed > limit or (speed == limit and not params.threshold_counts_as_stopped):
        return False
    yaw = yaw_of(inputs.qx, inputs.qy, inputs.qz, inputs.qw)
    nearest = nearest_index(
        points,
        inputs.n_points,
        inputs.x,
        inputs.y,
        yaw,
        params.ego_nearest_dist_threshold,
        params.ego_nearest_yaw_threshold,
    )
    target = _slowest_ahead(points, inputs.n_points, nearest, params.stopped_look_ahead)
    if abs(target) >= params.stop_state_entry_target_speed:
        return False
    if not params.keep_steer_control_until_converged:
        return True
    return is_steer_converged(params, points, inputs, lat, lat.cmd_prev_angle)


@kernel
def _output(command, lat, angle, rate):
    """Write the lateral part of the command."""
    command.steering_tire_angle = angle
    command.steering_tire_rotation_rate = rate
    lat.output_angle = angle


@kernel
def _hold(lat, command):
    """Stopped: repeat the previous command and let the MPC's memory rest on it."""
    for j in range(lat.delay_n):
        lat.delay[j] = lat.cmd_prev_angle
    lat.raw_prev = lat.cmd_prev_angle
    _output(command, lat, lat.cmd_prev_angle, lat.cmd_prev_rate)


@kernel
def _reset_raw(params, lat):
    """Start the rate limit from the measured angle, clamped so that the problem stays feasible."""
    limit = np.float32(params.max_steer_angle)
    lat.raw_prev = clip(lat.measured, -limit, limit)
    lat.raw_pprev = lat.raw_prev


@kernel
def _command_angle(params, inputs, lat, qp, trace, solved, now):
    """Angle and rate of this tick, and whether they are remembered; a failure holds the angle."""
    angle = lat.output_angle
    rate = np.float32(0.0)
    if solved:
        angle, rate = finish_mpc(params, lat, qp, trace, now)
    if solved and lat.is_under_control:
        remember_command(params, lat, angle, now)
    else:
        _reset_raw(params, lat)
    if params.steering_offset_is_input:
        if solved:
            angle = np.float32(angle - np.float32(lat.offset))
    elif params.steering_offset_enable_auto_steering_offset_removal:
        update_offset(params, lat, inputs.vx, inputs.wz, inputs.steer)
        if solved:
            angle = np.float32(angle + lat.offset)
    return angle, rate


@kernel
def _finish(params, points, inputs, lat, qp, command, trace, now, status):
    """Turn the solution, or its failure, into the lateral command."""
    solved = status == _SOLVED
    tell_solver(params, qp, trace, status)
    angle, rate = _command_angle(params, inputs, lat, qp, trace, solved, now)
    trace.stopped = _is_stopped(params, points, inputs, lat)
    trace.is_steer_converged = False
    if trace.stopped:
        _hold(lat, command)
    else:
        lat.cmd_prev_angle = angle
        lat.cmd_prev_rate = rate
        _output(command, lat, angle, rate)
        if solved and is_mpc_converged(params, lat):
            trace.is_steer_converged = is_steer_converged(params, points, inputs, lat, angle)
    command.is_defined_steering_tire_rotation_rate = solved
    trace.mpc_status = status
    trace.mpc_history_filled = lat.history_filled
    trace.shape_changed = has_shape_changed(params, points, inputs, lat)
    trace.is_forward_shift = lat.is_forward
    trace.under_control = lat.is_under_control
    trace.raw_steer_cmd_prev = lat.raw_prev
    trace.raw_steer_cmd_pprev = lat.raw_pprev
    trace.steering_offset = lat.offset


@entry(PARAMS, POINT, INPUTS, LATERAL_STATE, QP, COMMAND, TRACE, float)
def lateral_step(params, points, inputs, state, qp, command, trace, now):
    """One tick with a solver of our own; an MpcStatus.

    After a failure the last output angle is held with rate 0; NO_REFERENCE changes nothing.
    """
    lat = state[0]
    status = _prepare(params[0], points, inputs[0], lat, qp[0], trace[0], now)
    if status == _SOLVED:
        status = solve(params[0], lat, qp[0])
    if status != _NO_REFERENCE:
        _finish(params[0], points, inputs[0], lat, qp[0], command[0], trace[0], now, status)
    return status


@entry(PARAMS, POINT, INPUTS, LATERAL_STATE, QP, TRACE, float, on_demand=True)
def lateral_prepare(params, points, inputs, state, qp, trace, now):
    """The first part of ``lateral_step``, and the condensed problem for a solver that is no kernel.

    SOLVED means that it is ready to be solved.
    """
    status = _prepare(params[0], points, inputs[0], state[0], qp[0], trace[0], now)
    if status != _SOLVED:
        return status
    is_finite = condense(params[0], state[0], qp[0], params[0].mpc_prediction_horizon)
    return _SOLVED if is_finite else _INVALID_MATRIX


@entry(PARAMS, POINT, INPUTS, LATERAL_STATE, QP, COMMAND, TRACE, float, int, on_demand=True)
def lateral_finish(params, points, inputs, state, qp, command, trace, now, status):
    """The last part of ``lateral_step``: ``status`` is how the solver ended."""
    _finish(params[0], points, inputs[0], state[0], qp[0], command[0], trace[0], now, status)
    return status
