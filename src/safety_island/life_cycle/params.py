# SPDX-License-Identifier: Apache-2.0
"""Parameters of the life cycle."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from safety_island.life_cycle.limits import MAX_OVERRUN_WINDOW
from safety_island.parameter import parameter


class StopSteering(IntEnum):
    """The steering on the stop ramp: the last angle is held, or led back to the centre."""

    HOLD = 0
    CENTRE = 1


@dataclass(frozen=True)
class LifeCycleParams:
    """The life cycle (``life_cycle.param.yaml``)."""

    discovery_time: float = parameter(
        "s",
        "After joining a DDS domain, time to look for another island before anything is sent.",
        0.0,
        10.0,
        key="life_cycle.discovery_time",
    )
    moving_speed: float = parameter(
        "m/s",
        "Speed from which on a restarted island does not arm itself.",
        0.001,
        10.0,
        key="life_cycle.moving_speed",
    )
    stall_limit: float = parameter(
        "s",
        "Beyond one period: gap between two ticks, or sleep of the machine, after which the island"
        " starts anew.",
        0.01,
        3600.0,
        key="life_cycle.stall_limit",
    )
    fault_ticks: int = parameter(
        "ticks",
        "Ticks in a row that fail, or whose command the guard refuses, at which the output ends.",
        1,
        1000,
        key="life_cycle.fault_ticks",
    )
    mpc_failure_time: float = parameter(
        "s",
        "Time without a solution of the MPC, the last angle held, at which the output ends;"
        " 0: never.",
        0.0,
        60.0,
        key="life_cycle.mpc_failure_time",
    )
    overrun_ticks: int = parameter(
        "ticks",
        "Late ticks in a row that degrade; as many more end the output.",
        1,
        1000,
        key="life_cycle.overrun_ticks",
    )
    overrun_window: int = parameter(
        "ticks",
        "Ticks over which the mean period is taken.",
        2,
        MAX_OVERRUN_WINDOW,
        key="life_cycle.overrun_window",
    )
    overrun_ratio: float = parameter(
        "",
        "Period over mean period below which it counts as overrun.",
        0.1,
        1.0,
        key="life_cycle.overrun_ratio",
    )
    hold_ticks: int = parameter(
        "ticks",
        "CAN_ONLY: ticks for which the last command is repeated when the output must end.",
        0,
        100,
        key="life_cycle.hold_ticks",
    )
    stop_deceleration: float = parameter(
        "m/s^2",
        "CAN_ONLY: deceleration of the stop ramp.",
        0.1,
        10.0,
        key="life_cycle.stop.deceleration",
    )
    stop_jerk: float = parameter(
        "m/s^3", "CAN_ONLY: jerk of the stop ramp.", 0.1, 50.0, key="life_cycle.stop.jerk"
    )
    stop_hold: float = parameter(
        "s",
        "CAN_ONLY: time for which the stopped vehicle is held before silence.",
        0.0,
        60.0,
        key="life_cycle.stop.hold",
    )
    stop_steering: str = parameter(
        "",
        "CAN_ONLY: the steering on the stop ramp.",
        key="life_cycle.stop.steering",
        choices=tuple(item.name.lower() for item in StopSteering),
    )
    stop_steering_rate: float = parameter(
        "rad/s",
        "CAN_ONLY: rate at which the steering is led back to the centre.",
        0.01,
        10.0,
        key="life_cycle.stop.steering_rate",
    )
