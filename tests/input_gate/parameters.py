# SPDX-License-Identifier: Apache-2.0
"""The parameters that tests of the gate begin with."""

from __future__ import annotations

from safety_island.input_gate.params import GateParams

PARAMETERS = GateParams(
    trajectory_age_limit=0.9,
    odometry_age_limit=0.5,
    steering_age_limit=0.5,
    acceleration_age_limit=0.5,
    age_warning=0.28,
    clock_warning=0.1,
    map_frame="map",
    base_frame="base_link",
    min_trajectory_points=3,
    moving_speed=0.125,
    second_publisher="keep_first",
    writer_changes=3,
)
