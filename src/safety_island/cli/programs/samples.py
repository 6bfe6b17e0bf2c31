# SPDX-License-Identifier: Apache-2.0
"""Sample messages of the island's topics: a vehicle that drives straight on at 5 m/s."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from safety_island.control.records import POINT
from safety_island.control.status import Mode
from safety_island.dds.topics import TopicEntry
from safety_island.kernel.records import Records
from safety_island.messages import codec, inputs, outputs
from safety_island.messages.trajectory import encode_trajectory
from safety_island.messages.wire import Time

SPEED = 5.0
"""[m/s]"""
_POINTS = 101
_MAP, _BODY = "map", "base_link"


def sample(entry: TopicEntry, stamp: Time, travelled: float, speed: float = SPEED) -> bytes:
    """Return a message of a topic; ``travelled`` [m] since the start, ``speed`` [m/s] now.

    A topic that no sample was written for gets a message of default values.
    """
    make = _MAKERS.get(entry.key)
    return make(stamp, travelled, speed) if make else codec.encode(entry.type_name, {})


def _trajectory(stamp: Time, travelled: float, _: float) -> bytes:
    points: Records = np.zeros(_POINTS, POINT)
    points["x"] = np.floor(travelled) - 10.0 + np.arange(_POINTS)
    points["qw"] = 1.0
    points["v"] = SPEED
    return encode_trajectory(stamp, _MAP, points)


def _odometry(stamp: Time, x: float, speed: float) -> bytes:
    place = (x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    motion = (speed, 0.0, 0.0, 0.0, 0.0, 0.0)
    return inputs.encode_odometry(inputs.Odometry(stamp, _MAP, _BODY, *place, *motion))


def _acceleration(stamp: Time, *_: float) -> bytes:
    return inputs.encode_acceleration(inputs.Acceleration(stamp, _BODY, *(0.0,) * 6))


def _control(stamp: Time, *_: float) -> bytes:
    command = outputs.Control(stamp, stamp, 0.0, 0.0, SPEED, 0.0, is_defined_acceleration=True)
    return outputs.encode_control(command)


def _processing_time(stamp: Time, *_: float) -> bytes:
    return outputs.encode_float64_stamped(stamp, 0.1)


_MAKERS: dict[str, Callable[[Time, float, float], bytes]] = {
    "trajectory": _trajectory,
    "odometry": _odometry,
    "acceleration": _acceleration,
    "steering": lambda stamp, *_: inputs.encode_steering(inputs.Steering(stamp, 0.0)),
    "operation_mode": lambda stamp, *_: inputs.encode_operation_mode(
        inputs.OperationMode(stamp, Mode.AUTONOMOUS, True)
    ),
    "control": _control,
    "lateral_processing_time": _processing_time,
    "longitudinal_processing_time": _processing_time,
}
"""By the key of the topic table."""
