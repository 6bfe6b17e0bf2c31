# SPDX-License-Identifier: Apache-2.0
"""The cost that the MPC minimises, in one place: every weight by the name of its parameter.

Over the states x_(i+1) and the inputs u_i of the steps i = 0 .. n - 1:

    J = 1/2 sum_i  q_lat_i  lateral_error_(i+1)^2  +  q_yaw_i  yaw_error_(i+1)^2
      + 1/2 (u - u_ref)' R1 (u - u_ref)  +  1/2 u' R2 u

R1 holds the weights on the input and on its changes, R2 that on the lateral jerk. Both couple an
input with the two before it at most. So R1 + R2 is kept as three diagonals, and with
``pull`` = R1 u_ref the part of the inputs is, but for a constant,

    sum_i  1/2 r0_i u_i^2  +  r1_i u_i u_(i-1)  +  r2_i u_i u_(i-2)  -  pull_i u_i

The condensed problem, the recursion and the check of a solution read these columns and no weight.
Autoware: MPC::generateMPCMatrix, MPC::addSteerWeightR, MPC::addSteerWeightF.
"""

from safety_island.kernel.kernel import kernel


@kernel
def fill_cost(params, lat, n):
    """Fill the cost of every step from speed, curvature and feed-forward over the horizon."""
    for i in range(n):
        _weigh_step(params, lat, i, i == n - 1)
    _weigh_changes(params, lat, n)
    _weigh_first_changes(params, lat)
    _fill_pull(lat, n)
    _add_jerk(lat, n)


@kernel
def _weights(params, is_straight):
    """The set of weights in force: lateral and yaw error, input, each by speed, lateral jerk."""
    if is_straight:
        return (
            params.mpc_low_curvature_weight_lat_error,
            params.mpc_low_curvature_weight_heading_error,
            params.mpc_low_curvature_weight_heading_error_squared_vel,
            params.mpc_low_curvature_weight_steering_input,
            params.mpc_low_curvature_weight_steering_input_squared_vel,
            params.mpc_low_curvature_weight_lat_jerk,
        )
    return (
        params.mpc_weight_lat_error,
        params.mpc_weight_heading_error,
        params.mpc_weight_heading_error_squared_vel,
        params.mpc_weight_steering_input,
        params.mpc_weight_steering_input_squared_vel,
        params.mpc_weight_lat_jerk,
    )


@kernel
def _weigh_step(params, lat, i, is_last):
    """Weights of step i alone, from the low-curvature set where the path is nearly straight."""
    is_straight = abs(lat.hk[i]) < params.mpc_low_curvature_thresh_curvature
    lateral, heading, heading_v2, steer, steer_v2, jerk = _weights(params, is_straight)
    if is_last:
        lateral = params.mpc_weight_terminal_lat_error
        heading = params.mpc_weight_terminal_heading_error
    v2 = lat.hv[i] * lat.hv[i]
    dt = lat.prediction_dt
    lat.q_lat[i] = lateral
    lat.q_yaw[i] = heading + v2 * heading_v2
    lat.r0[i] = steer + v2 * steer_v2
    lat.r1[i] = 0.0
    lat.r2[i] = 0.0
    lat.jerk[i] = v2 * jerk / (dt * dt)


@kernel
def _weigh_changes(params, lat, n):
    """Steering rate (u_i - u_(i-1)) / dt and acceleration (u_i - 2 u_(i-1) + u_(i-2)) / dt^2.

    Their weights are always those of the nominal set.
    """
    dt = lat.prediction_dt
    rate = params.mpc_weight_steer_rate / (dt * dt)
    acc = params.mpc_weight_steer_acc / (dt * dt * dt * dt)
    for i in range(1, n):
        lat.r0[i - 1] += rate
        lat.r0[i] += rate
        lat.r1[i] -= rate
    for i in range(2, n):
        lat.r0[i - 2] += acc
        lat.r0[i - 1] += 4.0 * acc
        lat.r0[i] += acc
        lat.r1[i - 1] -= 2.0 * acc
        lat.r1[i] -= 2.0 * acc
        lat.r2[i] += acc


@kernel
def _weigh_first_changes(params, lat):
    """Rate and acceleration from the last command on, over the control period, as the firmware.

    It counts the last command as zero.
    """
    dt = lat.prediction_dt
    period = params.ctrl_period
    rate = params.mpc_weight_steer_rate
    acc = params.mpc_weight_steer_acc
    a = acc / (dt * dt * dt * dt)
    c1 = acc / (dt * dt * dt * period)
    c2 = acc / (dt * dt * period * period)
    c4 = acc / (period * period * period * period)
    lat.r0[0] += rate / (period * period) + (a + c2 + 2.0 * c1 + c4)
    lat.r0[1] += a
    lat.r1[1] -= a + c1


@kernel
def _fill_pull(lat, n):
    """pull = R1 u_ref, while r0, r1, r2 are R1 alone."""
    pull = lat.pull
    for i in range(n):
        pull[i] = lat.r0[i] * lat.u_ref[i]
    for i in range(1, n):
        pull[i] += lat.r1[i] * lat.u_ref[i - 1]
        pull[i - 1] += lat.r1[i] * lat.u_ref[i]
    for i in range(2, n):
        pull[i] += lat.r2[i] * lat.u_ref[i - 2]
        pull[i - 2] += lat.r2[i] * lat.u_ref[i]


@kernel
def _add_jerk(lat, n):
    """Lateral jerk v^2 (u_(i+1) - u_i) / dt, by the weight and speed of step i."""
    for i in range(1, n):
        jerk = lat.jerk[i - 1]
        lat.r0[i - 1] += jerk
        lat.r0[i] += jerk
        lat.r1[i] -= jerk
