# SPDX-License-Identifier: Apache-2.0
"""Why a value of our default set is what it is, where the sets differ."""

from dataclasses import fields

from safety_island.guard.params import GuardParams
from safety_island.parameter import key_of

_SAME_EVERYWHERE = ("speed_points", "shortest_step", "longest_step")
_GUARD = [key_of(item) for item in fields(GuardParams) if item.name not in _SAME_EVERYWHERE]

REASONS = {
    "autoware_release": (
        "the firmware's controllers are those of 0.40; with files of a newer release theirs are"
        " followed"
    ),
    "enable_deviation_checks": (
        "Autoware leaves them to its control_validator since 0.41, which an island does not have"
    ),
    "enable_overshoot_emergency": "the firmware's; Autoware has it off since 0.43",
    "stopping_state_stop_dist": "the firmware's; autoware_launch has 1 cm less",
    "slope_source": "the firmware's; Autoware has trajectory_goal_adaptive since 0.41",
    "ctrl_period": "the firmware's; Autoware's needs `--period 0.03`",
    "ego_nearest_dist_threshold": (
        "Autoware's; with 0 the search is global and jumps where a path crosses itself"
    ),
    "ego_nearest_yaw_threshold": "Autoware's; the same",
    "qp_solver_type": "exact, and holds the limits of angle and rate that the firmware's ignores",
    "input_delay": (
        "the firmware's; the demo's vehicle has 0.06 s of dead time, less than half a period, and"
        " `vehicle_model_steer_tau` covers it together with its lag of 0.2 s"
    ),
    "steering_offset.enable_auto_steering_offset_removal": (
        "the firmware's; for a vehicle whose steering sensor is off centre, switch it on"
    ),
    "steering_lpf_cutoff_hz": (
        "Autoware's; 10 Hz cannot act at 0.15 s. At 0.15 s 3 Hz smooths little, at 0.03 s it is the"
        " filter that Autoware runs"
    ),
    "error_deriv_lpf_cutoff_hz": "as the other filter: below 3.33 Hz, which Autoware's 5 Hz is not",
    "vehicle.mass_fl": "Autoware's, so that the dynamics model can be chosen",
    "vehicle.mass_fr": "the same",
    "vehicle.mass_rl": "the same",
    "vehicle.mass_rr": "the same",
    "vehicle.cf": "the same",
    "vehicle.cr": "the same",
    "symmetric_steer_rate_limits": (
        "looked up with the sign, right curves and reverse always get the first entry of a table"
    ),
    "pass_filters_above_nyquist": "a cutoff that cannot act is a mistake",
    "delay_compensation_time": "the firmware's, and that of the controller's own package",
    "gate.age_limit.trajectory": "nine missed trajectories of a planner at 10 Hz",
    "gate.age_limit.odometry": "ten missed samples of a localization at 20 Hz",
    "gate.age_limit.steering": "the same",
    "gate.age_limit.acceleration": "the same",
    "life_cycle.stall_limit": "what waited meanwhile is too old",
    "gate.min_trajectory_points": "fewer cannot be followed by the MPC",
    "life_cycle.mpc_failure_time": "a steering angle that is only held is no control",
    **dict.fromkeys(_GUARD, "nothing checks the firmware's commands; ours pass the guard"),
    "correct_reverse_signs": (
        "in reverse the firmware has the sign wrong in the acceleration feedback and in the slope"
        " term that comes from the trajectory's pitch"
    ),
}
"""YAML key -> reason, for every key in which two of the shipped sets differ."""
