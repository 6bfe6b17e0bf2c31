# SPDX-License-Identifier: Apache-2.0
"""The inputs of a tick but for the trajectory: their encoders and decoders.

Each decoder takes serialized plain CDR with its header, and raises DecodeError for whatever is not
a whole message. Values are not judged: NaN passes. The kernels that decode are loaded, and compiled
where they are on no disk, with the first sample.
"""

from __future__ import annotations

from functools import lru_cache
from struct import Struct
from typing import NamedTuple

from safety_island.messages import wire
from safety_island.messages.decoders import decoders
from safety_island.messages.wire import HEADER_LE, Time

ODOMETRY = "nav_msgs/msg/Odometry"
ACCELERATION = "geometry_msgs/msg/AccelWithCovarianceStamped"
STEERING = "autoware_vehicle_msgs/msg/SteeringReport"
OPERATION_MODE = "autoware_adapi_v1_msgs/msg/OperationModeState"

_TIME = Struct("<iI")
_STEERING = Struct("<4siIf")
_MODE = Struct("<4siIB6?")
_ZEROS = (0.0,) * 36


class Odometry(NamedTuple):
    """Pose [m] in ``frame_id``, velocity [m/s], [rad/s] in ``child_frame_id``."""

    stamp: Time
    frame_id: str
    child_frame_id: str
    x: float
    y: float
    z: float
    qx: float
    qy: float
    qz: float
    qw: float
    vx: float
    vy: float
    vz: float
    wx: float
    wy: float
    wz: float


class Acceleration(NamedTuple):
    """Acceleration [m/s^2], [rad/s^2] in ``frame_id``."""

    stamp: Time
    frame_id: str
    ax: float
    ay: float
    az: float
    angular_x: float
    angular_y: float
    angular_z: float


class Steering(NamedTuple):
    """Measured steering tyre angle [rad]."""

    stamp: Time
    steering_tire_angle: float


class OperationMode(NamedTuple):
    """Who drives: ``mode`` is a number of OperationModeState (AUTONOMOUS is 2)."""

    stamp: Time
    mode: int
    is_autoware_control_enabled: bool
    is_in_transition: bool = False
    is_stop_mode_available: bool = True
    is_autonomous_mode_available: bool = True
    is_local_mode_available: bool = True
    is_remote_mode_available: bool = True


def decode_odometry(data: bytes) -> Odometry:
    """Return the odometry of a nav_msgs/msg/Odometry; covariances are stepped over."""
    sec, nanosec, *rest = decoders().odometry(data, ODOMETRY)
    return Odometry(Time(sec, nanosec), *rest)


def encode_odometry(
    odometry: Odometry,
    pose_covariance: tuple[float, ...] = _ZEROS,
    twist_covariance: tuple[float, ...] = _ZEROS,
) -> bytes:
    """Return a nav_msgs/msg/Odometry; each covariance has 36 values, row by row."""
    prefix, tail = _odometry_layout(odometry.frame_id, odometry.child_frame_id)
    head = HEADER_LE + _TIME.pack(*odometry.stamp) + prefix
    values = (*odometry[3:10], *pose_covariance, *odometry[10:], *twist_covariance)
    return head + tail.pack(*values)


def decode_acceleration(data: bytes) -> Acceleration:
    """Return the acceleration of a geometry_msgs/msg/AccelWithCovarianceStamped."""
    sec, nanosec, *rest = decoders().acceleration(data, ACCELERATION)
    return Acceleration(Time(sec, nanosec), *rest)


def encode_acceleration(
    acceleration: Acceleration, covariance: tuple[float, ...] = _ZEROS
) -> bytes:
    """Return a geometry_msgs/msg/AccelWithCovarianceStamped; 36 covariances, row by row."""
    prefix, tail = _acceleration_layout(acceleration.frame_id)
    head = HEADER_LE + _TIME.pack(*acceleration.stamp) + prefix
    return head + tail.pack(*acceleration[2:], *covariance)


def decode_steering(data: bytes) -> Steering:
    """Return the angle of an autoware_vehicle_msgs/msg/SteeringReport."""
    sec, nanosec, *rest = decoders().steering(data, STEERING)
    return Steering(Time(sec, nanosec), *rest)


def encode_steering(steering: Steering) -> bytes:
    """Return an autoware_vehicle_msgs/msg/SteeringReport."""
    return _STEERING.pack(HEADER_LE, *steering.stamp, steering.steering_tire_angle)


def decode_operation_mode(data: bytes) -> OperationMode:
    """Return the state of an autoware_adapi_v1_msgs/msg/OperationModeState."""
    sec, nanosec, *rest = decoders().operation_mode(data, OPERATION_MODE)
    return OperationMode(Time(sec, nanosec), *rest)


def encode_operation_mode(state: OperationMode) -> bytes:
    """Return an autoware_adapi_v1_msgs/msg/OperationModeState."""
    return _MODE.pack(HEADER_LE, *state.stamp, *state[1:])


@lru_cache(maxsize=64)
def string_prefix(*texts: str) -> tuple[bytes, int]:
    """Return strings that follow a stamp, as bytes, and the place after them in the message."""
    start = len(HEADER_LE) + _TIME.size
    data = bytearray()
    for text in texts:
        body = wire.string_bytes(text)
        data += bytes(-(start + len(data)) & 3) + len(body).to_bytes(4, "little") + body
    return bytes(data), start + len(data)


@lru_cache(maxsize=64)
def _odometry_layout(frame_id: str, child_frame_id: str) -> tuple[bytes, Struct]:
    prefix, end = string_prefix(frame_id, child_frame_id)
    return prefix, Struct(f"<{wire.aligned(end, 8) - end}x85d")


@lru_cache(maxsize=64)
def _acceleration_layout(frame_id: str) -> tuple[bytes, Struct]:
    prefix, end = string_prefix(frame_id)
    return prefix, Struct(f"<{wire.aligned(end, 8) - end}x42d")
