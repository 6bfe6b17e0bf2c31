"""The lateral controller around the MPC: history, stopped state, convergence (control.md, section 6)."""

import numpy as np

from safety_island.control.convergence import (
    has_shape_changed,
    is_mpc_converged,
    is_steer_converged,
    remember_command,
    remember_end,
)
from safety_island.control.geometry import clip, yaw_of
from safety_island.control.kernel import entry, kernel
from safety_island.control.lateral_state import LATERAL_STATE
from safety_island.control.mpc import finish_mpc, prepare_mpc
from safety_island.control.points import nearest_index
from safety_island.control.qp import QP
from safety_island.control.records import COMMAND, INPUTS, PARAMS, POINT, TRACE
from safety_island.control.reference import accept_source, update_reference
from safety_island.control.solver import solve
from safety_island.control.status import Mode, MpcStatus
from safety_island.control.steering_offset import update_offset

_SOLVED = int(MpcStatus.SOLVED)
_NO_REFERENCE = int(MpcStatus.NO_REFERENCE)
_AUTONOMOUS = int(Mode.AUTONOMOUS)
_FEWEST_POINTS = 3


@kernel
def _set_trajectory(params, points, inputs, lat):
    """Take the trajectory in force as the reference, or keep the old one when it is too short."""
    if inputs.n_points < _FEWEST_POINTS:
        return
    if lat.source_id != inputs.trajectory_id:
        accept_source(points, inputs.n_points, lat)
        lat.source_id = inputs.trajectory_id
        last = points[inputs.n_points - 1]
        remember_end(params, lat, last.x, last.y, inputs.trajectory_stamp)
    update_reference(params, points, inputs, lat)


@kernel
def _measure(params, inputs, lat):
    """Note the measured angle, less the estimated offset, and who is in control."""
    lat.measured = inputs.steer
    if params.steering_offset_enable_auto_steering_offset_removal:
        lat.measured = np.float32(inputs.steer - lat.offset)
    lat.is_under_control = inputs.enabled and inputs.mode == _AUTONOMOUS
    if not lat.cmd_prev_valid or not lat.is_under_control:
        lat.cmd_prev_angle = lat.measured
        lat.cmd_prev_rate = np.float32(0.0)
        lat.cmd_prev_valid = True


@entry(PARAMS, POINT, INPUTS, LATERAL_STATE, QP, TRACE, float)
def lateral_prepare(params, points, inputs, state, qp, trace, now):
    """Take this tick's inputs and build the quadratic programme; an MpcStatus."""
    p = params[0]
    i = inputs[0]
    lat = state[0]
    t = trace[0]
    _set_trajectory(p, points, i, lat)
    t.lateral_ready = lat.ref_n > 0
    if lat.ref_n == 0:
        t.mpc_status = _NO_REFERENCE
        return _NO_REFERENCE
    _measure(p, i, lat)
    status = prepare_mpc(p, i, lat, qp[0], t, now)
    t.mpc_status = status
    return status


@kernel
def _is_stopped(params, points, inputs, lat):
    """Whether vehicle and trajectory stand still and the steering has come to rest."""
    if abs(inputs.vx) >= params.stop_state_entry_ego_speed:
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
    if abs(points[nearest].v) >= params.stop_state_entry_target_speed:
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


@entry(PARAMS, POINT, INPUTS, LATERAL_STATE, QP, COMMAND, TRACE, float, int)
def lateral_finish(params, points, inputs, state, qp, command, trace, now, status):
    """Turn the solution (or its failure) into the lateral command; returns ``status``.

    After a failure the last output angle is held with rate 0.
    """
    p = params[0]
    i = inputs[0]
    lat = state[0]
    t = trace[0]
    c = command[0]
    solved = status == _SOLVED
    angle = lat.output_angle
    rate = np.float32(0.0)
    if solved:
        angle, rate = finish_mpc(p, lat, qp[0], t, now)
    if solved and lat.is_under_control:
        remember_command(lat, angle, now)
    else:
        _reset_raw(p, lat)
    if p.steering_offset_enable_auto_steering_offset_removal:
        update_offset(p, lat, i.vx, i.wz, i.steer)
        angle = np.float32(angle + lat.offset) if solved else angle
    t.stopped = _is_stopped(p, points, i, lat)
    if t.stopped:
        _hold(lat, c)
        t.is_steer_converged = False
    else:
        lat.cmd_prev_angle = angle
        lat.cmd_prev_rate = rate
        _output(c, lat, angle, rate)
        t.is_steer_converged = (
            solved and is_mpc_converged(p, lat) and is_steer_converged(p, points, i, lat, angle)
        )
    c.is_defined_steering_tire_rotation_rate = solved
    t.mpc_status = status
    t.mpc_history_filled = lat.history_filled
    t.shape_changed = has_shape_changed(p, points, i, lat)
    t.is_forward_shift = lat.is_forward
    t.under_control = lat.is_under_control
    t.raw_steer_cmd_prev = lat.raw_prev
    t.raw_steer_cmd_pprev = lat.raw_pprev
    t.steering_offset = lat.offset
    return status


@entry(PARAMS, QP, TRACE)
def lateral_solve(params, qp, trace):
    """Solve the prepared problem with a solver of our own and check the solution."""
    return solve(params[0], qp[0], trace[0])
