# SPDX-License-Identifier: Apache-2.0
"""Parameters of the MPC lateral controller."""

from __future__ import annotations

import math
from dataclasses import dataclass

from safety_island.control.limits import MAX_HORIZON, MAX_OFFSET_SAMPLES
from safety_island.parameter import parameter, switch, weight


@dataclass(frozen=True)
class LateralParams:
    """The MPC lateral controller (``lateral/mpc.param.yaml``)."""

    enable_path_smoothing: bool = switch("Smooth the reference path with a moving average.")
    path_filter_moving_ave_num: int = parameter(
        "points", "Points on either side that the moving average takes in.", 0, 1000
    )
    curvature_smoothing_num_traj: int = parameter(
        "points", "Distance of the three points that give the curvature of the path.", 1, 1000
    )
    curvature_smoothing_num_ref_steer: int = parameter(
        "points", "The same for the curvature of the feed-forward angle.", 1, 1000
    )
    traj_resample_dist: float = parameter(
        "m", "Distance between the points of the reference path.", 0.02, 1.0
    )
    extend_trajectory_for_end_yaw_control: bool = switch(
        "Extend the path straight beyond its end, so that the last yaw is met."
    )
    admissible_position_error: float = parameter(
        "m", "Distance from the path beyond which the MPC gives up.", 0.1, 100.0
    )
    admissible_yaw_error_rad: float = parameter(
        "rad", "Yaw error beyond which the MPC gives up.", 0.01, math.pi
    )
    use_steer_prediction: bool = switch("Start from the predicted tyre angle, not the measured.")
    vehicle_model_steer_tau: float = parameter("s", "Time constant of the steering.", 0.01, 5.0)
    stop_state_entry_ego_speed: float = parameter(
        "m/s", "Speed below which the steering may be held.", 0.0, 1.0
    )
    stop_state_entry_target_speed: float = parameter(
        "m/s", "Target speed below which the steering may be held.", 0.0, 1.0
    )
    converged_steer_rad: float = parameter(
        "rad", "Distance of command and measurement that counts as converged.", 0.0, 1.5
    )
    keep_steer_control_until_converged: bool = switch(
        "Hold the steering at rest only once it has converged."
    )
    new_traj_duration_time: float = parameter(
        "s", "Time for which a changed trajectory shape counts as new.", 0.0, 10.0
    )
    new_traj_end_dist: float = parameter(
        "m", "Move of the trajectory's end that is a changed shape.", 0.0, 100.0
    )
    mpc_converged_threshold_rps: float = parameter(
        "rad", "Spread of the commands of the last second that counts as converged.", 0.0, 1.5
    )
    steer_rate_lim_dps_list_by_curvature: tuple[float, ...] = parameter(
        "deg/s", "Steering rate limits by curvature.", 0.0, 1000.0
    )
    curvature_list_for_steer_rate_lim: tuple[float, ...] = parameter(
        "1/m", "Curvatures at which they hold, ascending.", 0.0, 10.0
    )
    steer_rate_lim_dps_list_by_velocity: tuple[float, ...] = parameter(
        "deg/s", "Steering rate limits by speed.", 0.0, 1000.0
    )
    velocity_list_for_steer_rate_lim: tuple[float, ...] = parameter(
        "m/s", "Speeds at which they hold, ascending.", 0.0, 100.0
    )
    vehicle_model_type: str = parameter(
        "", "Prediction model.", choices=("kinematics", "kinematics_no_delay", "dynamics")
    )
    qp_solver_type: str = parameter(
        "",
        "Solver: exact without limits, OSQP (optional extra), or exact with all limits.",
        choices=("unconstraint_fast", "osqp", "daqp"),
    )
    input_delay: float = parameter(
        "s", "Dead time of the steering, rounded to whole control periods.", 0.0, 5.0
    )
    steering_offset_enable_auto_steering_offset_removal: bool = switch(
        "Take the offset of the steering sensor away: estimated, since 0.51 as a topic tells it.",
        key="steering_offset.enable_auto_steering_offset_removal",
    )
    steering_offset_update_vel_threshold: float = parameter(
        "m/s",
        "Speed above which the offset is estimated (until 0.50).",
        0.0,
        60.0,
        key="steering_offset.update_vel_threshold",
    )
    steering_offset_update_steer_threshold: float = parameter(
        "rad",
        "Tyre angle below which it is estimated (until 0.50).",
        0.0,
        1.5,
        key="steering_offset.update_steer_threshold",
    )
    steering_offset_steering_offset_limit: float = parameter(
        "rad",
        "Largest estimated offset, either side (until 0.50).",
        0.0,
        0.5,
        key="steering_offset.steering_offset_limit",
    )
    steering_offset_average_num: int = parameter(
        "samples",
        "Samples that are averaged (until 0.50).",
        1,
        MAX_OFFSET_SAMPLES,
        key="steering_offset.average_num",
    )
    steering_offset_steer_offset_filter_cutoff_hz: float = parameter(
        "Hz",
        "Cutoff of the low pass on an offset that comes from a topic (since 0.51).",
        0.01,
        1000.0,
        key="steering_offset.steer_offset_filter_cutoff_hz",
    )
    steering_offset_max_update_th: float = parameter(
        "rad",
        "Largest step of an offset that comes from a topic (since 0.51).",
        0.0,
        0.5,
        key="steering_offset.max_update_th",
    )
    steering_offset_input_limit: float = parameter(
        "rad",
        "Largest offset, either side, that is accepted from a topic (since 0.51).",
        0.0,
        0.5,
        key="steering_offset.input_limit",
    )
    steering_lpf_cutoff_hz: float = parameter(
        "Hz", "Cutoff of the low pass on the steering command.", 0.01, 1000.0
    )
    error_deriv_lpf_cutoff_hz: float = parameter(
        "Hz", "Cutoff of the low pass on the error rates (dynamics model).", 0.01, 1000.0
    )
    mpc_prediction_horizon: int = parameter("steps", "Steps of the prediction.", 2, MAX_HORIZON)
    mpc_prediction_dt: float = parameter("s", "Shortest length of one step.", 0.01, 1.0)
    mpc_weight_lat_error: float = weight("Weight of the lateral error.")
    mpc_weight_heading_error: float = weight("Weight of the heading error.")
    mpc_weight_heading_error_squared_vel: float = weight(
        "Weight of the heading error, times the speed squared."
    )
    mpc_weight_steering_input: float = weight("Weight of the angle off the feed-forward.")
    mpc_weight_steering_input_squared_vel: float = weight(
        "Weight of the angle off the feed-forward, times the speed squared."
    )
    mpc_weight_lat_jerk: float = weight("Weight of the lateral jerk.")
    mpc_weight_steer_rate: float = weight("Weight of the steering rate.")
    mpc_weight_steer_acc: float = weight("Weight of the steering acceleration.")
    mpc_weight_terminal_lat_error: float = weight("Weight of the lateral error at the last step.")
    mpc_weight_terminal_heading_error: float = weight(
        "Weight of the heading error at the last step."
    )
    mpc_low_curvature_weight_lat_error: float = weight("The same where the path is straight.")
    mpc_low_curvature_weight_heading_error: float = weight("The same where the path is straight.")
    mpc_low_curvature_weight_heading_error_squared_vel: float = weight(
        "The same where the path is straight."
    )
    mpc_low_curvature_weight_steering_input: float = weight("The same where the path is straight.")
    mpc_low_curvature_weight_steering_input_squared_vel: float = weight(
        "The same where the path is straight."
    )
    mpc_low_curvature_weight_lat_jerk: float = weight("The same where the path is straight.")
    mpc_low_curvature_weight_steer_rate: float = weight("Not used by the controllers.")
    mpc_low_curvature_weight_steer_acc: float = weight("Not used by the controllers.")
    mpc_low_curvature_thresh_curvature: float = parameter(
        "1/m", "Curvature below which the path counts as straight; 0: never.", 0.0, 10.0
    )
    mpc_zero_ff_steer_deg: float = parameter(
        "deg", "Feed-forward angle below which it is taken as 0.", 0.0, 90.0
    )
    mpc_acceleration_limit: float = parameter(
        "m/s^2", "Limit of the velocity filter on the reference.", 0.01, 20.0
    )
    mpc_velocity_time_constant: float = parameter(
        "s", "Time constant of the velocity filter on the reference.", 0.001, 10.0
    )
    mpc_min_prediction_length: float = parameter(
        "m", "Length that the prediction covers at least; its steps grow for it.", 0.1, 200.0
    )
    vehicle_mass_fl: float = parameter(
        "kg", "Load on the front left wheel (dynamics).", 0.0, 1e5, key="vehicle.mass_fl"
    )
    vehicle_mass_fr: float = parameter(
        "kg", "Load on the front right wheel (dynamics).", 0.0, 1e5, key="vehicle.mass_fr"
    )
    vehicle_mass_rl: float = parameter(
        "kg", "Load on the rear left wheel (dynamics).", 0.0, 1e5, key="vehicle.mass_rl"
    )
    vehicle_mass_rr: float = parameter(
        "kg", "Load on the rear right wheel (dynamics).", 0.0, 1e5, key="vehicle.mass_rr"
    )
    vehicle_cf: float = parameter(
        "N/rad", "Cornering stiffness of the front axle (dynamics).", 0.0, 1e7, key="vehicle.cf"
    )
    vehicle_cr: float = parameter(
        "N/rad", "Cornering stiffness of the rear axle (dynamics).", 0.0, 1e7, key="vehicle.cr"
    )
    symmetric_steer_rate_limits: bool = switch(
        "Look steering-rate limits up by the absolute curvature and speed, not the signed ones."
    )
    pass_filters_above_nyquist: bool = switch(
        "Let a cutoff stand above the Nyquist frequency; that filter passes its input through."
    )
