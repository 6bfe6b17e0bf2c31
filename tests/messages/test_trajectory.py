# SPDX-License-Identifier: Apache-2.0
"""Trajectories: the shifted first point, for every alignment, against independent bytes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.control.records import new_points
from safety_island.kernel.cdr import DecodeReason
from safety_island.messages.errors import DecodeError
from safety_island.messages.points import POINT, Points
from safety_island.messages.trajectory import (
    TRAJECTORY,
    decode_trajectory,
    encode_trajectory,
)
from safety_island.messages.wire import Time
from tests.messages.oracle import rosbags_bytes
from tests.messages.samples import STAMP, points, trajectory_bytes
from tests.messages.strategies import FLOAT32, FLOAT64, TEXTS, TIMES

ROWS = st.lists(st.tuples(TIMES, st.tuples(*[FLOAT64] * 7), st.tuples(*[FLOAT32] * 6)), max_size=5)
FLOATS = (
    "longitudinal_velocity_mps",
    "lateral_velocity_mps",
    "acceleration_mps2",
    "heading_rate_rps",
    "front_wheel_angle_rad",
    "rear_wheel_angle_rad",
)
FRAMES = ["", "m", "ma", "map", "map1", "map_2", "map__3", "map___4"]


def message_of(stamp: Time, frame: str, rows: Any) -> dict[str, Any]:
    """The trajectory as a plain message: each point with its own time."""
    found = []
    for time, pose, speeds in rows:
        position = dict(zip("xyz", pose[:3], strict=True))
        orientation = dict(zip("xyzw", pose[3:], strict=True))
        found.append(
            {
                "time_from_start": time._asdict(),
                "pose": {"position": position, "orientation": orientation},
                **dict(zip(FLOATS, speeds, strict=True)),
            }
        )
    return {"header": {"stamp": stamp._asdict(), "frame_id": frame}, "points": found}


def points_of(rows: Any) -> Points:
    """The same points as records: each with the time of the next."""
    made = np.zeros(len(rows), POINT)
    for i, (_, pose, speeds) in enumerate(rows):
        following = rows[i + 1][0] if i + 1 < len(rows) else (0, 0)
        made[i] = (*pose, *speeds, *following)
    return made


@settings(max_examples=150, deadline=None)
@given(TIMES, TEXTS, ROWS)
def test_encode_and_decode_equal_independent_bytes(stamp: Time, frame: str, rows: Any) -> None:
    made = points_of(rows)
    first = rows[0][0] if rows else Time()
    data = encode_trajectory(stamp, frame, made, first)
    assert data == rosbags_bytes(TRAJECTORY, message_of(stamp, frame, rows))
    found = decode_trajectory(data)
    assert (found.stamp, found.frame_id, found.first_time) == (stamp, frame, first)
    assert found.points.tobytes() == made.tobytes()


@settings(max_examples=50, deadline=None)
@given(TIMES, TEXTS, ROWS)
def test_big_endian(stamp: Time, frame: str, rows: Any) -> None:
    data = rosbags_bytes(TRAJECTORY, message_of(stamp, frame, rows), little_endian=False)
    assert decode_trajectory(data).points.tobytes() == points_of(rows).tobytes()


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("count", [0, 1, 2, 300])
def test_every_alignment(frame: str, count: int) -> None:
    found = decode_trajectory(trajectory_bytes(count, frame))
    assert found[:2] == (STAMP, frame) and found.first_time == (Time(0, 5) if count else Time())
    assert found.points.tobytes() == points(count).tobytes()


def test_decoded_points_are_fit_for_a_kernel() -> None:
    found = decode_trajectory(trajectory_bytes(7)).points
    assert found.flags.aligned and found.flags.c_contiguous and found.flags.writeable
    assert found.dtype is POINT or found.dtype == POINT


def test_decoding_into_the_memory_of_the_controller() -> None:
    memory = new_points()
    memory["x"] = -1.0
    found = decode_trajectory(trajectory_bytes(5), memory)
    assert np.shares_memory(found.points, memory)
    assert memory[:5].tobytes() == points(5).tobytes()
    assert (memory["x"][5:] == -1.0).all()


def test_more_points_than_there_is_room_for_are_refused_by_number() -> None:
    memory = new_points()[:4]
    memory["x"] = -1.0
    with pytest.raises(DecodeError, match="5 points, at most 4 are taken") as refused:
        decode_trajectory(trajectory_bytes(5), memory)
    assert refused.value.reason is DecodeReason.LENGTH
    assert (memory["x"] == -1.0).all()


def test_a_frame_that_comes_back_is_its_own() -> None:
    """The layout of the message before is remembered; an empty one between changes nothing."""
    for frame, count in [("map", 2), ("odom", 0), ("map", 3), ("map", 0), ("odom", 1), ("map", 1)]:
        found = decode_trajectory(encode_trajectory(STAMP, frame, points(count)))
        assert (found.frame_id, len(found.points)) == (frame, count)


def test_first_time_is_zero_when_it_is_not_given() -> None:
    assert decode_trajectory(encode_trajectory(STAMP, "map", points(2))).first_time == (0, 0)
