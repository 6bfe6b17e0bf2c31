# SPDX-License-Identifier: Apache-2.0
"""Trajectory points: their place on the wire, as NumPy types.

Seen from the first ``position.x`` on, the data of a trajectory repeat every 88 bytes: pose, six
floats, the time of the *next* point. The first time stands alone in front, with four bytes of
padding behind it when the sequence starts at 4 modulo 8.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

_HEAD: list[tuple[str, str]] = [
    ("x", "<f8"),  # position [m]
    ("y", "<f8"),
    ("z", "<f8"),
    ("qx", "<f8"),  # orientation
    ("qy", "<f8"),
    ("qz", "<f8"),
    ("qw", "<f8"),
    ("v", "<f4"),  # longitudinal_velocity_mps [m/s]
    ("v_lat", "<f4"),  # lateral_velocity_mps [m/s]
    ("acc", "<f4"),  # acceleration_mps2 [m/s^2]
    ("heading_rate", "<f4"),  # heading_rate_rps [rad/s]
    ("front_wheel", "<f4"),  # front_wheel_angle_rad [rad]
    ("rear_wheel", "<f4"),  # rear_wheel_angle_rad [rad]
]
_TIME: list[tuple[str, str]] = [("sec", "<i4"), ("nanosec", "<u4")]

POINT: Any = np.dtype((np.record, np.dtype([*_HEAD, *_TIME], align=True)))
"""One point, 88 bytes; ``sec`` and ``nanosec`` are the time_from_start of the *next* point.

The same layout as ``control.records.POINT`` (a test compares them).
"""

TIME_SIZE = 8

Points = npt.NDArray[Any]
"""A one-dimensional array of POINT records."""
