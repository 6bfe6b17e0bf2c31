# SPDX-License-Identifier: Apache-2.0
"""Edits of single messages on the wire: decode, change, encode again under the same stamp."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from safety_island.control.records import POINT
from safety_island.kernel.records import Records
from safety_island.messages import inputs
from safety_island.messages.trajectory import decode_trajectory, encode_trajectory

Edit = Callable[[bytes], bytes]
Change = Callable[[Records], Records | None]
"""A change of points: in place, or others in their place."""

COVARIANCES = 36


def odometry(**changes: Any) -> Edit:
    """Give fields of the odometry these values."""
    return lambda data: inputs.encode_odometry(inputs.decode_odometry(data)._replace(**changes))


def acceleration(**changes: Any) -> Edit:
    """Give fields of the acceleration these values."""
    return lambda data: inputs.encode_acceleration(
        inputs.decode_acceleration(data)._replace(**changes)
    )


def steering(angle: float) -> Edit:
    """Give the steering report this angle."""
    return lambda data: inputs.encode_steering(
        inputs.decode_steering(data)._replace(steering_tire_angle=angle)
    )


def covariances(value: float) -> dict[str, Edit]:
    """Fill the covariances, which nobody reads, of each message that has some."""
    fill = (value,) * COVARIANCES
    return {
        "odometry": lambda data: inputs.encode_odometry(inputs.decode_odometry(data), fill, fill),
        "acceleration": lambda data: inputs.encode_acceleration(
            inputs.decode_acceleration(data), fill
        ),
    }


def points(change: Change, frame_id: str = "") -> Edit:
    """Let a function change the points of the trajectory in place, or return others."""

    def edit(data: bytes) -> bytes:
        message = decode_trajectory(data)
        changed = change(message.points)
        made = message.points if changed is None else changed
        return encode_trajectory(message.stamp, frame_id or message.frame_id, made)

    return edit


def point(place: int, field: str, value: float) -> Edit:
    """Give one field of one point a value; a place below zero counts from the end."""

    def change(found: Records) -> None:
        found[field][place] = value

    return points(change)


POSE_AND_SPEED = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "wz")
"""The fields of the odometry that are used."""
UNUSED_ODOMETRY = ("vz", "wx", "wy")
UNUSED_ACCELERATION = ("ay", "az", "angular_x", "angular_y", "angular_z")
POINT_FIELDS = POINT.names[:13]


def one_value(value: float) -> dict[str, tuple[str, Edit]]:
    """Return edits that give one used field this value: name -> topic and edit."""
    found: dict[str, tuple[str, Edit]] = {
        f"odometry.{name}": ("odometry", odometry(**{name: value})) for name in POSE_AND_SPEED
    }
    found["steering"] = "steering", steering(value)
    found["acceleration.ax"] = "acceleration", acceleration(ax=value)
    for name in POINT_FIELDS:
        for where, index in (("first", 0), ("middle", 50), ("last", -1)):
            found[f"trajectory.{where}.{name}"] = "trajectory", point(index, name, value)
    return found
