"""Every parameter of the controllers and the node: name, type, unit, range.

The names are Autoware's own, a dot in a key written as an underscore. There are no defaults here:
values live in the parameter sets (``safety_island.params``), each with its source.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


def parameter(
    unit: str,
    doc: str,
    *,
    low: float = float("-inf"),
    high: float = float("inf"),
    key: str | None = None,
    choices: tuple[str, ...] | None = None,
) -> Any:
    """Declare a parameter: its unit, what it means, the closed range that is allowed."""
    meta = {"unit": unit, "doc": doc, "low": low, "high": high, "key": key, "choices": choices}
    return field(metadata=meta)


@dataclass(frozen=True)
class VehicleParams:
    """Dimensions of the vehicle (``vehicle_info.param.yaml``)."""

    wheel_radius: float = parameter("", "")
    wheel_width: float = parameter("", "")
    wheel_base: float = parameter("", "")
    wheel_tread: float = parameter("", "")
    front_overhang: float = parameter("", "")
    rear_overhang: float = parameter("", "")
    left_overhang: float = parameter("", "")
    right_overhang: float = parameter("", "")
    vehicle_height: float = parameter("", "")
    max_steer_angle: float = parameter("", "")


@dataclass(frozen=True)
class NodeParams:
    """The controller node (``trajectory_follower_node.param.yaml`` and ``nearest_search``)."""

    ctrl_period: float = parameter("", "")
    timeout_thr_sec: float = parameter("", "")
    lateral_controller_mode: str = parameter("", "", choices=("mpc",))
    longitudinal_controller_mode: str = parameter("", "", choices=("pid",))
    ego_nearest_dist_threshold: float = parameter("", "")
    ego_nearest_yaw_threshold: float = parameter("", "")


@dataclass(frozen=True)
class LateralParams:
    """The MPC lateral controller (``lateral/mpc.param.yaml``)."""

    enable_path_smoothing: bool = parameter("", "")
    path_filter_moving_ave_num: int = parameter("", "")
    curvature_smoothing_num_traj: int = parameter("", "")
    curvature_smoothing_num_ref_steer: int = parameter("", "")
    traj_resample_dist: float = parameter("", "")
    extend_trajectory_for_end_yaw_control: bool = parameter("", "")
    admissible_position_error: float = parameter("", "")
    admissible_yaw_error_rad: float = parameter("", "")
    use_steer_prediction: bool = parameter("", "")
    vehicle_model_steer_tau: float = parameter("", "")
    stop_state_entry_ego_speed: float = parameter("", "")
    stop_state_entry_target_speed: float = parameter("", "")
    converged_steer_rad: float = parameter("", "")
    keep_steer_control_until_converged: bool = parameter("", "")
    new_traj_duration_time: float = parameter("", "")
    new_traj_end_dist: float = parameter("", "")
    mpc_converged_threshold_rps: float = parameter("", "")
    steer_rate_lim_dps_list_by_curvature: tuple[float, ...] = parameter("", "")
    curvature_list_for_steer_rate_lim: tuple[float, ...] = parameter("", "")
    steer_rate_lim_dps_list_by_velocity: tuple[float, ...] = parameter("", "")
    velocity_list_for_steer_rate_lim: tuple[float, ...] = parameter("", "")
    vehicle_model_type: str = parameter("", "", choices=("kinematics", "kinematics_no_delay", "dynamics"))
    qp_solver_type: str = parameter("", "", choices=("unconstraint_fast", "osqp", "daqp"))
    input_delay: float = parameter("", "")
    steering_offset_enable_auto_steering_offset_removal: bool = parameter("", "", key="steering_offset.enable_auto_steering_offset_removal")
    steering_offset_update_vel_threshold: float = parameter("", "", key="steering_offset.update_vel_threshold")
    steering_offset_update_steer_threshold: float = parameter("", "", key="steering_offset.update_steer_threshold")
    steering_offset_steering_offset_limit: float = parameter("", "", key="steering_offset.steering_offset_limit")
    steering_offset_average_num: int = parameter("", "", key="steering_offset.average_num")
    steering_lpf_cutoff_hz: float = parameter("", "")
    error_deriv_lpf_cutoff_hz: float = parameter("", "")
    mpc_prediction_horizon: int = parameter("", "")
    mpc_prediction_dt: float = parameter("", "")
    mpc_weight_lat_error: float = parameter("", "")
    mpc_weight_heading_error: float = parameter("", "")
    mpc_weight_heading_error_squared_vel: float = parameter("", "")
    mpc_weight_steering_input: float = parameter("", "")
    mpc_weight_steering_input_squared_vel: float = parameter("", "")
    mpc_weight_lat_jerk: float = parameter("", "")
    mpc_weight_steer_rate: float = parameter("", "")
    mpc_weight_steer_acc: float = parameter("", "")
    mpc_weight_terminal_lat_error: float = parameter("", "")
    mpc_weight_terminal_heading_error: float = parameter("", "")
    mpc_low_curvature_weight_lat_error: float = parameter("", "")
    mpc_low_curvature_weight_heading_error: float = parameter("", "")
    mpc_low_curvature_weight_heading_error_squared_vel: float = parameter("", "")
    mpc_low_curvature_weight_steering_input: float = parameter("", "")
    mpc_low_curvature_weight_steering_input_squared_vel: float = parameter("", "")
    mpc_low_curvature_weight_lat_jerk: float = parameter("", "")
    mpc_low_curvature_weight_steer_rate: float = parameter("", "")
    mpc_low_curvature_weight_steer_acc: float = parameter("", "")
    mpc_low_curvature_thresh_curvature: float = parameter("", "")
    mpc_zero_ff_steer_deg: float = parameter("", "")
    mpc_acceleration_limit: float = parameter("", "")
    mpc_velocity_time_constant: float = parameter("", "")
    mpc_min_prediction_length: float = parameter("", "")
    vehicle_mass_fl: float = parameter("", "", key="vehicle.mass_fl")
    vehicle_mass_fr: float = parameter("", "", key="vehicle.mass_fr")
    vehicle_mass_rl: float = parameter("", "", key="vehicle.mass_rl")
    vehicle_mass_rr: float = parameter("", "", key="vehicle.mass_rr")
    vehicle_cf: float = parameter("", "", key="vehicle.cf")
    vehicle_cr: float = parameter("", "", key="vehicle.cr")


@dataclass(frozen=True)
class LongitudinalParams:
    """The PID longitudinal controller (``longitudinal/pid.param.yaml``)."""

    delay_compensation_time: float = parameter("", "")
    enable_smooth_stop: bool = parameter("", "")
    enable_overshoot_emergency: bool = parameter("", "")
    enable_large_tracking_error_emergency: bool = parameter("", "")
    enable_slope_compensation: bool = parameter("", "")
    enable_keep_stopped_until_steer_convergence: bool = parameter("", "")
    drive_state_stop_dist: float = parameter("", "")
    drive_state_offset_stop_dist: float = parameter("", "")
    stopping_state_stop_dist: float = parameter("", "")
    stopped_state_entry_duration_time: float = parameter("", "")
    stopped_state_entry_vel: float = parameter("", "")
    stopped_state_entry_acc: float = parameter("", "")
    emergency_state_overshoot_stop_dist: float = parameter("", "")
    emergency_state_traj_trans_dev: float = parameter("", "")
    emergency_state_traj_rot_dev: float = parameter("", "")
    kp: float = parameter("", "")
    ki: float = parameter("", "")
    kd: float = parameter("", "")
    max_out: float = parameter("", "")
    min_out: float = parameter("", "")
    max_p_effort: float = parameter("", "")
    min_p_effort: float = parameter("", "")
    max_i_effort: float = parameter("", "")
    min_i_effort: float = parameter("", "")
    max_d_effort: float = parameter("", "")
    min_d_effort: float = parameter("", "")
    lpf_vel_error_gain: float = parameter("", "")
    enable_integration_at_low_speed: bool = parameter("", "")
    current_vel_threshold_pid_integration: float = parameter("", "")
    time_threshold_before_pid_integration: float = parameter("", "")
    enable_brake_keeping_before_stop: bool = parameter("", "")
    brake_keeping_acc: float = parameter("", "")
    smooth_stop_max_strong_acc: float = parameter("", "")
    smooth_stop_min_strong_acc: float = parameter("", "")
    smooth_stop_weak_acc: float = parameter("", "")
    smooth_stop_weak_stop_acc: float = parameter("", "")
    smooth_stop_strong_stop_acc: float = parameter("", "")
    smooth_stop_max_fast_vel: float = parameter("", "")
    smooth_stop_min_running_vel: float = parameter("", "")
    smooth_stop_min_running_acc: float = parameter("", "")
    smooth_stop_weak_stop_time: float = parameter("", "")
    smooth_stop_weak_stop_dist: float = parameter("", "")
    smooth_stop_strong_stop_dist: float = parameter("", "")
    stopped_vel: float = parameter("", "")
    stopped_acc: float = parameter("", "")
    emergency_vel: float = parameter("", "")
    emergency_acc: float = parameter("", "")
    emergency_jerk: float = parameter("", "")
    lpf_acc_error_gain: float = parameter("", "")
    acc_feedback_gain: float = parameter("", "")
    max_acc: float = parameter("", "")
    min_acc: float = parameter("", "")
    max_jerk: float = parameter("", "")
    min_jerk: float = parameter("", "")
    max_acc_cmd_diff: float = parameter("", "")
    adaptive_trajectory_velocity_th: float = parameter("", "")
    lpf_pitch_gain: float = parameter("", "")
    max_pitch_rad: float = parameter("", "")
    min_pitch_rad: float = parameter("", "")
    slope_source: str = parameter("", "", choices=("raw_pitch", "trajectory_pitch", "trajectory_adaptive"))


@dataclass(frozen=True)
class Parameters:
    """One complete set."""

    vehicle: VehicleParams
    node: NodeParams
    lateral: LateralParams
    longitudinal: LongitudinalParams
