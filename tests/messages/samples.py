# SPDX-License-Identifier: Apache-2.0
"""Ordinary messages, one of each hot type, with what it takes to decode and compare them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from safety_island.messages import arm, inputs, outputs, status, trajectory
from safety_island.messages.points import POINT, Points
from safety_island.messages.status import NO_VALUE, STATUS_RECORD
from safety_island.messages.status_fields import Status
from safety_island.messages.wire import HEADER_LE, Time

STAMP = Time(1_700_000_000, 123_456_789)


@dataclass(frozen=True)
class Hot:
    """A hot message type: its name, its decoder and one encoded sample."""

    name: str
    decode: Callable[[bytes], Any]
    data: bytes


def points(count: int) -> Points:
    """Return points with a different number in every field."""
    made = np.zeros(count, POINT)
    for place, field in enumerate(POINT.names):
        made[field] = np.arange(count) * 16 + place
    if count:
        made["sec"][-1] = made["nanosec"][-1] = 0
    return made


def trajectory_bytes(count: int, frame_id: str = "map") -> bytes:
    """Return a trajectory of so many points."""
    return trajectory.encode_trajectory(STAMP, frame_id, points(count), Time(0, 5))


def status_bytes() -> bytes:
    """Return a status with a different number in every byte that may have any value."""
    record = np.zeros(1, STATUS_RECORD)
    raw = record.view("u1")
    raw[:] = np.arange(len(raw)) % 101 + 1
    for name in ("degraded", "armed", "engaged", "control_enabled", "published"):
        record[name] = True
    return HEADER_LE + record.tobytes()


def status_of_nothing() -> Status:
    """Return the status of an island that has heard and done nothing."""
    zero = status.decode_status(HEADER_LE + bytes(STATUS_RECORD.itemsize))
    row = zero.inputs[0]._replace(
        age=math.inf, age_limit=math.inf, transport_delay=math.nan, last_refusal=NO_VALUE
    )
    errors = ("lateral_error", "yaw_error", "residual", "stop_dist", "target_vel")
    command = ("command_angle", "command_rate", "command_velocity", "command_acceleration")
    enumerations = ("subject", "longitudinal_state", "mpc_status", "guard_verdict")
    unknown: dict[str, Any] = dict.fromkeys((*errors, *command), math.nan)
    unknown |= dict.fromkeys(enumerations, NO_VALUE)
    return zero._replace(inputs=(row,) * len(zero.inputs), **unknown)


def hot_messages(count: int = 3) -> list[Hot]:
    """Return one sample of each hot type; the trajectory has ``count`` points."""
    numbers = [0.5 + i for i in range(13)]
    odometry = inputs.Odometry(STAMP, "map", "base_link", *numbers)
    acceleration = inputs.Acceleration(STAMP, "/base_link", *numbers[:6])
    steering = inputs.Steering(STAMP, 0.125)
    mode = inputs.OperationMode(STAMP, 2, True, False, True)
    control = outputs.Control(STAMP, Time(7, 8), 0.125, -0.5, 12.25, -1.5, 0.0, True)
    return [
        Hot(inputs.ODOMETRY, inputs.decode_odometry, inputs.encode_odometry(odometry)),
        Hot(
            inputs.ACCELERATION,
            inputs.decode_acceleration,
            inputs.encode_acceleration(acceleration),
        ),
        Hot(inputs.STEERING, inputs.decode_steering, inputs.encode_steering(steering)),
        Hot(
            inputs.OPERATION_MODE, inputs.decode_operation_mode, inputs.encode_operation_mode(mode)
        ),
        Hot(trajectory.TRAJECTORY, trajectory.decode_trajectory, trajectory_bytes(count)),
        Hot(outputs.CONTROL, outputs.decode_control, outputs.encode_control(control)),
        Hot(
            outputs.FLOAT64_STAMPED,
            outputs.decode_float64_stamped,
            outputs.encode_float64_stamped(STAMP, 1.5),
        ),
        Hot(status.STATUS, status.decode_status, status_bytes()),
        Hot(arm.ARM, arm.decode_arm, arm.encode_arm(arm.Arm(STAMP, 2**63 + 1))),
    ]
