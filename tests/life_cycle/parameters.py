# SPDX-License-Identifier: Apache-2.0
"""The parameters that tests of the life cycle begin with."""

from __future__ import annotations

from safety_island.life_cycle.params import LifeCycleParams

PARAMETERS = LifeCycleParams(
    discovery_time=1.0,
    moving_speed=0.125,
    stall_limit=0.5,
    fault_ticks=3,
    mpc_failure_time=0.5,
    overrun_ticks=3,
    overrun_window=8,
    overrun_ratio=0.5,
    hold_ticks=2,
    stop_deceleration=2.0,
    stop_jerk=4.0,
    stop_hold=0.5,
    stop_steering="hold",
    stop_steering_rate=0.5,
)
"""Numbers that are exact in binary, so that a boundary is one."""
