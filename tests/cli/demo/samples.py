# SPDX-License-Identifier: Apache-2.0
"""Events as the processes of a demo report them."""

from __future__ import annotations

from typing import Any

TICK: dict[str, Any] = {
    "event": "tick",
    "number": 7,
    "outcome": "PUBLISHED",
    "detail": "",
    "state": "ACTIVE",
    "reason": "NONE",
    "subject": None,
    "guard": "PASSED",
    "guard_limits": [],
    "lateness_s": 0.0001,
    "skipped": 0,
    "tick_s": 0.00042,
    "ages_s": {
        "trajectory": 0.06,
        "odometry": 0.011,
        "steering": 0.012,
        "acceleration": 0.013,
        "operation mode": 30.0,
    },
    "refused": 0,
    "steering_tire_angle": 0.1,
    "steering_tire_rotation_rate": 0.0,
    "velocity": 8.0,
    "acceleration": 0.5,
    "longitudinal_state": "DRIVE",
    "mpc_status": "SOLVED",
    "lateral_error": 0.02,
    "stop_dist": 80.0,
}

WAITING: dict[str, Any] = {
    key: value
    for key, value in TICK.items()
    if key in ("event", "number", "lateness_s", "skipped", "tick_s", "refused")
} | {
    "outcome": "WAITING_FOR_INPUT",
    "detail": "odometry",
    "ages_s": {"trajectory": 0.1, "odometry": None, "operation mode": None},
}

STATUS: dict[str, Any] = {
    "event": "status",
    "time_s": 12.3,
    "station": 84.2,
    "length": 325.0,
    "lap": 0,
    "stop_station": 325.0,
    "x": 94.0,
    "y": 30.0,
    "yaw": 0.4,
    "speed": 7.81,
    "target_speed": 8.0,
    "acceleration": 0.4,
    "steering": 0.09,
    "lateral_error": -0.031,
    "slope": 0.0798,
    "operation_mode": "AUTONOMOUS",
    "gate": "driving",
}

VEHICLE_SUMMARY: dict[str, Any] = {
    "event": "summary",
    "on_course": True,
    "reached_speed": True,
    "stopped_in_place": True,
    "max_lateral_error": 0.042,
    "top_speed": 7.98,
    "top_target": 8.0,
    "stop_errors": [-0.12],
}

ISLAND_SUMMARY: dict[str, Any] = {
    "event": "summary",
    "ticks": 400,
    "published": 390,
    "missed_ticks": 0,
    "tick_times_s": {"median": 0.0004, "p99": 0.0008, "max": 0.002},
}
