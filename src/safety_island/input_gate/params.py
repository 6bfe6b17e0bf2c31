# SPDX-License-Identifier: Apache-2.0
"""Parameters of the input gate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from safety_island.parameter import parameter


def _age(name: str) -> Any:
    doc = f"Age of the {name} at which the output ends."
    return parameter("s", doc, 0.01, 3600.0, key=f"gate.age_limit.{name}")


@dataclass(frozen=True)
class GateParams:
    """The input gate (``gate.param.yaml``)."""

    trajectory_age_limit: float = _age("trajectory")
    odometry_age_limit: float = _age("odometry")
    steering_age_limit: float = _age("steering")
    acceleration_age_limit: float = _age("acceleration")
    age_warning: float = parameter(
        "s",
        "Age of odometry, steering or acceleration that is warned of.",
        0.01,
        60.0,
        key="gate.age_warning",
    )
    clock_warning: float = parameter(
        "s",
        "Distance of a stamp from the island's wall clock that is warned of.",
        0.001,
        3600.0,
        key="gate.clock_warning",
    )
    map_frame: str = parameter(
        "", "Frame of trajectory and odometry; empty: any.", key="gate.map_frame"
    )
    base_frame: str = parameter(
        "", "Frame of the vehicle's own motion; empty: any.", key="gate.base_frame"
    )
    min_trajectory_points: int = parameter(
        "points", "Fewest points of a trajectory.", 2, 100, key="gate.min_trajectory_points"
    )
    moving_speed: float = parameter(
        "m/s",
        "Speed from which on the same odometry twice counts as frozen.",
        0.001,
        10.0,
        key="gate.moving_speed",
    )
    second_publisher: str = parameter(
        "",
        "When a second publisher appears on an input or on the command: keep to the first and"
        " alarm, or go silent.",
        key="gate.second_publisher",
        choices=("keep_first", "silent"),
    )
    writer_changes: int = parameter(
        "changes",
        "Changes of an input's publisher within 1 s at which the output ends.",
        2,
        1000,
        key="gate.writer_changes",
    )
