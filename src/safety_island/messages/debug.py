# SPDX-License-Identifier: Apache-2.0
"""The messages of the debug topics: what Autoware's own tools look at."""

from __future__ import annotations

from collections.abc import Sequence
from struct import Struct
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from safety_island.messages.codec import encode
from safety_island.messages.registry import struct_of
from safety_island.messages.wire import HEADER_LE, Time

CONTROL_HORIZON = "autoware_control_msgs/msg/ControlHorizon"
FLOAT32_ARRAY_STAMPED = "autoware_internal_debug_msgs/msg/Float32MultiArrayStamped"
DIAGNOSTIC_ARRAY = "diagnostic_msgs/msg/DiagnosticArray"
DIAGNOSTIC_STATUS = "diagnostic_msgs/msg/DiagnosticStatus"

_HORIZON = Struct("<4s iIiI f I")
_ARRAY = Struct("<4s iI I")
_TIME = [("sec", "<i4"), ("nanosec", "<u4")]
_COMMAND: Any = np.dtype(
    [
        ("stamp", _TIME),
        ("control_time", _TIME),
        ("lateral_stamp", _TIME),
        ("lateral_control_time", _TIME),
        ("steering_tire_angle", "<f4"),
        ("steering_tire_rotation_rate", "<f4"),
        ("is_defined_steering_tire_rotation_rate", "?"),
        ("longitudinal_stamp", _TIME),
        ("longitudinal_control_time", _TIME),
        ("velocity", "<f4"),
        ("acceleration", "<f4"),
        ("jerk", "<f4"),
        ("is_defined_acceleration", "?"),
        ("is_defined_jerk", "?"),
    ],
    align=True,
)
"""One Control of a sequence; all but the last are padded to a multiple of four bytes."""
_END_PADDING = 2


class Diagnostic(NamedTuple):
    """One status of a DiagnosticArray."""

    name: str
    message: str
    is_error: bool = False
    values: tuple[tuple[str, str], ...] = ()
    hardware_id: str = ""


def encode_control_horizon(
    stamp: Time,
    time_step_s: float,
    angles: npt.NDArray[np.float32],
    rates: npt.NDArray[np.float32],
    velocity: float,
    acceleration: float,
) -> bytes:
    """Return a ControlHorizon of steering angles [rad] and rates [rad/s], shape (n,) each.

    Every element has the one velocity [m/s] and acceleration [m/s^2]. As in a command of the
    island, rate and acceleration are defined, the jerk is not; every control_time is zero.
    """
    controls: Any = np.zeros(len(angles), _COMMAND)
    for name in ("stamp", "lateral_stamp", "longitudinal_stamp"):
        controls[name] = tuple(stamp)
    controls["steering_tire_angle"] = angles
    controls["steering_tire_rotation_rate"] = rates
    controls["is_defined_steering_tire_rotation_rate"] = True
    controls["velocity"] = velocity
    controls["acceleration"] = acceleration
    controls["is_defined_acceleration"] = True
    head = _HORIZON.pack(HEADER_LE, *stamp, 0, 0, time_step_s * 1e3, len(angles))
    body: bytes = controls.tobytes()
    return head + (body[:-_END_PADDING] if body else b"")


def encode_float32_array_stamped(stamp: Time, values: npt.NDArray[np.float32]) -> bytes:
    """Return a Float32MultiArrayStamped of numbers of shape (n,)."""
    return _ARRAY.pack(HEADER_LE, *stamp, len(values)) + values.astype("<f4").tobytes()


def encode_diagnostics(stamp: Time, diagnostics: Sequence[Diagnostic]) -> bytes:
    """Return a diagnostic_msgs/msg/DiagnosticArray."""
    message = {
        "header": {"stamp": stamp._asdict(), "frame_id": ""},
        "status": [_status(item) for item in diagnostics],
    }
    return encode(DIAGNOSTIC_ARRAY, message)


def _status(item: Diagnostic) -> dict[str, Any]:
    return {
        "level": _LEVELS["ERROR" if item.is_error else "OK"],
        "name": item.name,
        "message": item.message,
        "hardware_id": item.hardware_id,
        "values": [{"key": key, "value": value} for key, value in item.values],
    }


_LEVELS = dict(struct_of(DIAGNOSTIC_STATUS).constants)
