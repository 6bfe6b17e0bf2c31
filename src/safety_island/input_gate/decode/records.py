# SPDX-License-Identifier: Apache-2.0
"""Records of the decoding kernels: the bytes of a sample, and what each kind of input says.

Values are those on the wire, not judged: NaN passes. A text is kept as its place in the bytes.
"""

from __future__ import annotations

import numpy as np

from safety_island.control.limits import MAX_POINTS
from safety_island.control.records import POINT
from safety_island.kernel.cdr import HEADER_SIZE
from safety_island.kernel.records import Records, record

TEXT_ROOM = 8192
"""Bytes of a sample beside its points: the names of its frames, and padding."""

START = 4
"""Place of a sample's first byte in the memory: its body begins at a multiple of eight."""
BODY = START + HEADER_SIZE

MAX_SAMPLE = MAX_POINTS * POINT.itemsize + TEXT_ROOM
"""Bytes of the largest sample that is looked at."""

SAMPLE = record(
    [
        ("n_bytes", "i8"),  # bytes of the sample
        ("at", "i8"),  # the next byte to read, counted in ``bytes``
        ("found", "i8"),  # what a refusal speaks of: bytes, points, or a byte's value
        ("text_at", "i8"),  # the string that was read last: its place in ``bytes``
        ("text_size", "i8"),  # and its length, without the closing NUL
        ("is_big", "i8"),  # 1: big endian; numbers are turned where they stand when they are read
        ("bytes", "u1", (BODY + MAX_SAMPLE,)),  # the sample, from START on
    ]
)
"""The bytes of a sample, and how far they are read."""

_STAMP = [("sec", "i4"), ("nanosec", "u4")]
_FRAME = [("frame_at", "i8"), ("frame_size", "i8")]  # place and length in ``bytes``

TRAJECTORY = record(
    [
        *_STAMP,
        *_FRAME,
        ("n", "i8"),  # points
        ("points_at", "i8"),  # place of the first ``position.x`` in ``bytes``
        ("first_sec", "i4"),  # time_from_start of the first point
        ("first_nanosec", "u4"),
    ]
)
"""An autoware_planning_msgs/msg/Trajectory but for its points."""

ODOMETRY = record(
    [
        *_STAMP,
        *_FRAME,
        ("child_at", "i8"),  # child_frame_id
        ("child_size", "i8"),
        ("x", "f8"),  # position in the frame [m]
        ("y", "f8"),
        ("z", "f8"),
        ("qx", "f8"),  # orientation
        ("qy", "f8"),
        ("qz", "f8"),
        ("qw", "f8"),
        ("vx", "f8"),  # velocity in the child frame [m/s]
        ("vy", "f8"),
        ("vz", "f8"),
        ("wx", "f8"),  # turn rate in the child frame [rad/s]
        ("wy", "f8"),
        ("wz", "f8"),
    ]
)
"""A nav_msgs/msg/Odometry; its covariances are stepped over."""

STEERING = record([*_STAMP, ("angle", "f4")])
"""An autoware_vehicle_msgs/msg/SteeringReport: tyre angle [rad]."""

ACCELERATION = record(
    [
        *_STAMP,
        *_FRAME,
        ("ax", "f8"),  # [m/s^2]
        ("ay", "f8"),
        ("az", "f8"),
        ("angular_x", "f8"),  # [rad/s^2]
        ("angular_y", "f8"),
        ("angular_z", "f8"),
    ]
)
"""A geometry_msgs/msg/AccelWithCovarianceStamped; its covariance is stepped over."""

OPERATION_MODE = record(
    [
        *_STAMP,
        ("mode", "u1"),  # of OperationModeState; AUTONOMOUS is 2
        ("is_autoware_control_enabled", "?"),
        ("is_in_transition", "?"),
        ("is_stop_mode_available", "?"),
        ("is_autonomous_mode_available", "?"),
        ("is_local_mode_available", "?"),
        ("is_remote_mode_available", "?"),
    ]
)
"""An autoware_adapi_v1_msgs/msg/OperationModeState."""


def new_sample() -> Records:
    """Return memory for the bytes of one sample."""
    return np.zeros(1, SAMPLE)
