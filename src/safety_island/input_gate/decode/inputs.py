# SPDX-License-Identifier: Apache-2.0
"""The five inputs, from plain CDR of either byte order.

Each kernel reads the sample in a SAMPLE record, fills the record of its kind, and returns GOOD or
the DecodeReason for which the bytes are no such message; the record is then of no use. Numbers of a
big-endian sample are turned in place, so a sample is read once.
"""

import numpy as np

from safety_island.control.records import POINT
from safety_island.input_gate.decode.reading import (
    check_end,
    read_encapsulation,
    read_frame,
    read_stamp,
    read_string,
    take,
    take_count,
    turn,
)
from safety_island.input_gate.decode.records import (
    ACCELERATION,
    ODOMETRY,
    OPERATION_MODE,
    SAMPLE,
    STEERING,
    TRAJECTORY,
)
from safety_island.input_gate.reason import GOOD
from safety_island.kernel.cdr import DecodeReason
from safety_island.kernel.kernel import entry, kernel

_TRUNCATED = int(DecodeReason.TRUNCATED)
_LENGTH = int(DecodeReason.LENGTH)
_BOOLEAN = int(DecodeReason.BOOLEAN)

_COVARIANCE = 36  # numbers
_TIME_SIZE = 8
_POINT_SIZE = POINT.itemsize
_POINT_WORDS = _POINT_SIZE // 8
_POINT_DOUBLES = 7  # then numbers of four bytes


@entry(SAMPLE, TRAJECTORY)
def decode_trajectory(samples, trajectories):
    """Decode a trajectory but for its points, which the sample holds whole."""
    sample, message = samples[0], trajectories[0]
    reason = read_encapsulation(sample)
    if reason == GOOD:
        reason = read_frame(sample, message)
    if reason != GOOD:
        return reason
    message.n = take_count(sample)
    if message.n < 0:
        return _TRUNCATED
    message.first_sec = 0
    message.first_nanosec = 0
    if message.n > 0:
        reason = _find_points(sample, message)
    return check_end(sample) if reason == GOOD else reason


@kernel
def _find_points(sample, message):
    """Read the time of the first point, and step over the rest of all points.

    Seen from the first ``position.x`` on the bytes repeat: pose, six floats, the time of the next.
    """
    start = take(sample, _TIME_SIZE, 4)
    if start < 0:
        return _TRUNCATED
    turn(sample, start, 4, 2)
    message.first_sec = sample.bytes.view(np.int32)[start >> 2]
    message.first_nanosec = sample.bytes.view(np.uint32)[(start >> 2) + 1]
    message.points_at = take(sample, message.n * _POINT_SIZE - _TIME_SIZE, 8)
    return _TRUNCATED if message.points_at < 0 else GOOD


@entry(SAMPLE, TRAJECTORY, POINT)
def copy_points(samples, trajectories, points):
    """Copy the points of a trajectory that was decoded; what has no room is refused untouched.

    Each record holds the time of the point after it; that of the last is zero.
    """
    sample, message = samples[0], trajectories[0]
    sample.found = message.n
    if message.n > len(points):
        return _LENGTH
    if message.n == 0:
        return GOOD
    for i in range(message.n if sample.is_big else 0):
        start = message.points_at + i * _POINT_SIZE
        halves = (_POINT_WORDS - _POINT_DOUBLES) * 2
        turn(sample, start, 8, _POINT_DOUBLES)
        turn(sample, start + _POINT_DOUBLES * 8, 4, halves if i < message.n - 1 else halves - 2)
    source = sample.bytes.view(np.int64)
    target = points.view(np.int64)
    first = message.points_at >> 3
    last = message.n * _POINT_WORDS - 1
    for i in range(last):
        target[i] = source[first + i]
    target[last] = 0
    return GOOD


@kernel
def _take_doubles(sample, turned, size):
    """Step over ``size`` numbers, of which the first ``turned`` are used; their place, or -1."""
    start = take(sample, size * 8, 8)
    if start < 0:
        return -1
    turn(sample, start, 8, turned)
    return start >> 3


@entry(SAMPLE, ODOMETRY)
def decode_odometry(samples, odometries):
    """Decode odometry."""
    sample, message = samples[0], odometries[0]
    reason = read_encapsulation(sample)
    if reason == GOOD:
        reason = read_frame(sample, message)
    if reason == GOOD:
        reason = read_string(sample)
        message.child_at = sample.text_at
        message.child_size = sample.text_size
    if reason != GOOD:
        return reason
    pose = _take_doubles(sample, 7, 7 + _COVARIANCE)
    twist = -1 if pose < 0 else _take_doubles(sample, 6, 6 + _COVARIANCE)
    if twist < 0:
        return _TRUNCATED
    numbers = sample.bytes.view(np.float64)
    message.x = numbers[pose]
    message.y = numbers[pose + 1]
    message.z = numbers[pose + 2]
    message.qx = numbers[pose + 3]
    message.qy = numbers[pose + 4]
    message.qz = numbers[pose + 5]
    message.qw = numbers[pose + 6]
    message.vx = numbers[twist]
    message.vy = numbers[twist + 1]
    message.vz = numbers[twist + 2]
    message.wx = numbers[twist + 3]
    message.wy = numbers[twist + 4]
    message.wz = numbers[twist + 5]
    return check_end(sample)


@entry(SAMPLE, STEERING)
def decode_steering(samples, steerings):
    """Decode a measured steering angle."""
    sample, message = samples[0], steerings[0]
    reason = read_encapsulation(sample)
    if reason == GOOD:
        reason = read_stamp(sample, message)
    if reason != GOOD:
        return reason
    start = take(sample, 4, 4)
    if start < 0:
        return _TRUNCATED
    turn(sample, start, 4, 1)
    message.angle = sample.bytes.view(np.float32)[start >> 2]
    return check_end(sample)


@entry(SAMPLE, ACCELERATION)
def decode_acceleration(samples, accelerations):
    """Decode an acceleration."""
    sample, message = samples[0], accelerations[0]
    reason = read_encapsulation(sample)
    if reason == GOOD:
        reason = read_frame(sample, message)
    if reason != GOOD:
        return reason
    start = _take_doubles(sample, 6, 6 + _COVARIANCE)
    if start < 0:
        return _TRUNCATED
    numbers = sample.bytes.view(np.float64)
    message.ax = numbers[start]
    message.ay = numbers[start + 1]
    message.az = numbers[start + 2]
    message.angular_x = numbers[start + 3]
    message.angular_y = numbers[start + 4]
    message.angular_z = numbers[start + 5]
    return check_end(sample)


@entry(SAMPLE, OPERATION_MODE)
def decode_operation_mode(samples, modes):
    """Decode who drives."""
    sample, message = samples[0], modes[0]
    reason = read_encapsulation(sample)
    if reason == GOOD:
        reason = read_stamp(sample, message)
    if reason != GOOD:
        return reason
    start = take(sample, 7, 1)
    if start < 0:
        return _TRUNCATED
    data = sample.bytes
    for place in range(start + 1, start + 7):
        if data[place] > 1:
            sample.found = data[place]
            return _BOOLEAN
    message.mode = data[start]
    message.is_autoware_control_enabled = data[start + 1] == 1
    message.is_in_transition = data[start + 2] == 1
    message.is_stop_mode_available = data[start + 3] == 1
    message.is_autonomous_mode_available = data[start + 4] == 1
    message.is_local_mode_available = data[start + 5] == 1
    message.is_remote_mode_available = data[start + 6] == 1
    return check_end(sample)
