# SPDX-License-Identifier: Apache-2.0
"""Parameters of the vehicle and of the controller node."""

from __future__ import annotations

import math
from dataclasses import dataclass

from safety_island.control.release import RELEASES
from safety_island.parameter import parameter, switch


@dataclass(frozen=True)
class VehicleParams:
    """Dimensions of the vehicle (``vehicle_info.param.yaml``)."""

    wheel_radius: float = parameter(
        "m", "Radius of a wheel; not used by the controllers.", 0.01, 3.0
    )
    wheel_width: float = parameter("m", "Width of a wheel; not used by the controllers.", 0.01, 3.0)
    wheel_base: float = parameter("m", "Wheelbase: front axle to rear axle.", 0.1, 20.0)
    wheel_tread: float = parameter(
        "m", "Left wheel to right wheel; not used by the controllers.", 0.05, 10.0
    )
    front_overhang: float = parameter(
        "m", "Front axle to front bumper; not used by the controllers.", -10.0, 10.0
    )
    rear_overhang: float = parameter(
        "m", "Rear axle to rear bumper; not used by the controllers.", -10.0, 10.0
    )
    left_overhang: float = parameter(
        "m", "Left wheel to left side; not used by the controllers.", -5.0, 5.0
    )
    right_overhang: float = parameter(
        "m", "Right wheel to right side; not used by the controllers.", -5.0, 5.0
    )
    vehicle_height: float = parameter(
        "m", "Ground to roof; not used by the controllers.", 0.05, 10.0
    )
    max_steer_angle: float = parameter(
        "rad", "Largest tyre angle, either side; the steering command is clamped to it.", 0.05, 1.5
    )


@dataclass(frozen=True)
class NodeParams:
    """The controller node (``trajectory_follower_node.param.yaml`` and ``nearest_search``)."""

    ctrl_period: float = parameter("s", "Time from one tick to the next.", 0.005, 1.0)
    timeout_thr_sec: float = parameter(
        "s", "Age at which a command of either controller is no longer published.", 0.01, 10.0
    )
    cyclic_message_timeout_thr_sec: float = parameter(
        "s",
        "Age of the trajectory beyond which the diagnostic cyclic_message_timeout is an error"
        " (since 0.51); it ends no output.",
        0.01,
        60.0,
    )
    autoware_release: str = parameter(
        "",
        "Release of Autoware whose rules the controllers follow; unless it is given, the keys of"
        " Autoware's files decide it.",
        choices=RELEASES,
    )
    enable_deviation_checks: bool = switch(
        "Give up following beyond admissible_* and emergency_state_traj_*; Autoware leaves that to"
        " its control_validator since 0.41."
    )
    trajectory_reference_mode: str = parameter(
        "",
        "Where the vehicle should be now: at the nearest place of the trajectory (spatial), or"
        " where the clock says (temporal, Autoware 0.53).",
        choices=("spatial", "temporal"),
    )
    lateral_controller_mode: str = parameter("", "Lateral controller.", choices=("mpc",))
    longitudinal_controller_mode: str = parameter("", "Longitudinal controller.", choices=("pid",))
    ego_nearest_dist_threshold: float = parameter(
        "m", "Nearest search: points further away count only if none is nearer.", 0.0, 100.0
    )
    ego_nearest_yaw_threshold: float = parameter(
        "rad", "Nearest search: points turned away by more count only if no other.", 0.0, math.pi
    )
