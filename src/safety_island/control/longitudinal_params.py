# SPDX-License-Identifier: Apache-2.0
"""Parameters of the PID longitudinal controller."""

from __future__ import annotations

import math
from dataclasses import dataclass

from safety_island.parameter import parameter, switch


@dataclass(frozen=True)
class LongitudinalParams:
    """The PID longitudinal controller (``longitudinal/pid.param.yaml``)."""

    delay_compensation_time: float = parameter(
        "s", "Time by which the target lies ahead, for the delay of the acceleration.", 0.0, 2.0
    )
    enable_smooth_stop: bool = switch("Stop with the smooth stop (state STOPPING).")
    enable_overshoot_emergency: bool = switch("Brake hard after passing the stop point.")
    enable_large_tracking_error_emergency: bool = switch(
        "Enter the state EMERGENCY when too far from the trajectory."
    )
    enable_slope_compensation: bool = switch("Add the pull of the slope to the acceleration.")
    enable_keep_stopped_until_steer_convergence: bool = switch(
        "Do not drive off before the steering has converged."
    )
    drive_state_stop_dist: float = parameter(
        "m", "Distance to the stop point beyond which STOPPED becomes DRIVE.", 0.0, 20.0
    )
    drive_state_offset_stop_dist: float = parameter(
        "m", "Added to that for STOPPING to become DRIVE.", 0.0, 20.0
    )
    stopping_state_stop_dist: float = parameter(
        "m", "Distance to the stop point below which DRIVE becomes STOPPING.", 0.0, 20.0
    )
    stopped_state_entry_duration_time: float = parameter(
        "s", "Time at rest before the state is STOPPED.", 0.0, 10.0
    )
    stopped_state_entry_vel: float = parameter(
        "m/s", "Speed below which the vehicle counts as at rest.", 0.0, 2.0
    )
    stopped_state_entry_acc: float = parameter(
        "m/s^2",
        "Acceleration below which it counts as at rest; not used by the controllers.",
        0.0,
        10.0,
    )
    emergency_state_overshoot_stop_dist: float = parameter(
        "m", "Distance past the stop point that is an emergency.", 0.0, 100.0
    )
    emergency_state_traj_trans_dev: float = parameter(
        "m", "Distance from the trajectory beyond which only braking is left.", 0.1, 100.0
    )
    emergency_state_traj_rot_dev: float = parameter(
        "rad", "Yaw off the trajectory beyond which only braking is left.", 0.01, math.pi
    )
    kp: float = parameter("1/s", "Proportional gain on the speed error.", 0.0, 100.0)
    ki: float = parameter("1/s^2", "Integral gain on the speed error.", 0.0, 100.0)
    kd: float = parameter("", "Derivative gain on the speed error.", 0.0, 100.0)
    max_out: float = parameter("m/s^2", "Largest feedback.", 0.0, 100.0)
    min_out: float = parameter("m/s^2", "Smallest feedback.", -100.0, 0.0)
    max_p_effort: float = parameter("m/s^2", "Largest proportional term.", 0.0, 100.0)
    min_p_effort: float = parameter("m/s^2", "Smallest proportional term.", -100.0, 0.0)
    max_i_effort: float = parameter("m/s^2", "Largest integral term.", 0.0, 100.0)
    min_i_effort: float = parameter("m/s^2", "Smallest integral term.", -100.0, 0.0)
    max_d_effort: float = parameter("m/s^2", "Largest derivative term.", 0.0, 100.0)
    min_d_effort: float = parameter("m/s^2", "Smallest derivative term.", -100.0, 0.0)
    lpf_vel_error_gain: float = parameter(
        "", "Part of the old value that the filter of the speed error keeps.", 0.0, 1.0
    )
    enable_integration_at_low_speed: bool = switch(
        "Integrate at low speed too, some time after control was taken over."
    )
    current_vel_threshold_pid_integration: float = parameter(
        "m/s", "Speed above which the speed error is integrated.", 0.0, 60.0
    )
    time_threshold_before_pid_integration: float = parameter(
        "s", "Time under control before it is integrated at low speed.", 0.0, 60.0
    )
    ff_scale_min: float = parameter(
        "",
        "Smallest factor on the trajectory's acceleration, by speed over target speed.",
        0.0,
        1.0,
    )
    ff_scale_max: float = parameter("", "Largest factor on it.", 1.0, 10.0)
    enable_brake_keeping_before_stop: bool = switch("Do not let go of the brake before a stop.")
    brake_keeping_acc: float = parameter(
        "m/s^2", "Weakest braking that is kept before a stop.", -20.0, 0.0
    )
    smooth_stop_max_strong_acc: float = parameter(
        "m/s^2", "Weakest of the strong braking, while still fast.", -20.0, 0.0
    )
    smooth_stop_min_strong_acc: float = parameter(
        "m/s^2", "Strongest of the strong braking, while still fast.", -20.0, 0.0
    )
    smooth_stop_weak_acc: float = parameter("m/s^2", "Braking just before rest.", -20.0, 0.0)
    smooth_stop_weak_stop_acc: float = parameter(
        "m/s^2", "Braking a little past the stop point.", -20.0, 0.0
    )
    smooth_stop_strong_stop_acc: float = parameter(
        "m/s^2", "Braking at rest, or far past the stop point.", -20.0, 0.0
    )
    smooth_stop_max_fast_vel: float = parameter(
        "m/s", "Speed above which braking is strong when the time to rest is unknown.", 0.0, 20.0
    )
    smooth_stop_min_running_vel: float = parameter(
        "m/s", "Speed above which the vehicle still runs.", 0.0, 5.0
    )
    smooth_stop_min_running_acc: float = parameter(
        "m/s^2", "Acceleration above which the vehicle still runs.", 0.0, 10.0
    )
    smooth_stop_weak_stop_time: float = parameter(
        "s", "Time to rest, without the delay, beyond which braking is strong.", 0.0, 10.0
    )
    smooth_stop_weak_stop_dist: float = parameter(
        "m", "Distance to the stop point that is a little past it.", -20.0, 20.0
    )
    smooth_stop_strong_stop_dist: float = parameter(
        "m", "Distance to the stop point that is far past it.", -20.0, 20.0
    )
    stopped_vel: float = parameter("m/s", "Speed command in STOPPED.", 0.0, 1.0)
    stopped_acc: float = parameter("m/s^2", "Acceleration command in STOPPED.", -20.0, 0.0)
    emergency_vel: float = parameter("m/s", "Speed that EMERGENCY goes toward.", 0.0, 1.0)
    emergency_acc: float = parameter("m/s^2", "Braking in EMERGENCY.", -20.0, -0.1)
    emergency_jerk: float = parameter(
        "m/s^3", "Rate at which the braking of EMERGENCY builds up.", -100.0, -0.1
    )
    lpf_acc_error_gain: float = parameter(
        "", "Part of the old value that the filter of the acceleration error keeps.", 0.0, 1.0
    )
    acc_feedback_gain: float = parameter("", "Gain on the acceleration error.", 0.0, 10.0)
    max_acc: float = parameter("m/s^2", "Largest acceleration command.", 0.0, 20.0)
    min_acc: float = parameter("m/s^2", "Smallest acceleration command.", -20.0, -0.1)
    max_jerk: float = parameter("m/s^3", "Largest jerk of the command.", 0.1, 100.0)
    min_jerk: float = parameter("m/s^3", "Smallest jerk of the command.", -100.0, -0.1)
    max_acc_cmd_diff: float = parameter(
        "m/s^3", "Largest change of the published acceleration in either direction.", 0.1, 1000.0
    )
    adaptive_trajectory_velocity_th: float = parameter(
        "m/s", "Speed above which trajectory_adaptive takes the trajectory's pitch.", 0.0, 60.0
    )
    lpf_pitch_gain: float = parameter(
        "", "Part of the old value that the filter of the pitch keeps.", 0.0, 1.0
    )
    max_pitch_rad: float = parameter("rad", "Largest pitch that is compensated.", 0.0, 0.5)
    min_pitch_rad: float = parameter("rad", "Smallest pitch that is compensated.", -0.5, 0.0)
    slope_source: str = parameter(
        "",
        "Where the slope is taken from.",
        choices=(
            "raw_pitch",
            "trajectory_pitch",
            "trajectory_adaptive",
            "trajectory_goal_adaptive",
        ),
    )
    correct_reverse_signs: bool = switch(
        "Use the right signs of acceleration feedback and slope in reverse, as Autoware does since"
        " 0.46 and 0.53."
    )
