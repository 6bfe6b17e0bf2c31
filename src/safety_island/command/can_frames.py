# SPDX-License-Identifier: Apache-2.0
"""Kernel: a command as three CAN frames, each signal at its place in the table of ``frames``."""

import math

from safety_island.command.encoding import Encoding
from safety_island.command.frames import FRAME_BYTES, FRAMES
from safety_island.command.mode import OutputMode
from safety_island.kernel.kernel import entry, kernel
from safety_island.kernel.records import record

CAN_COMMAND = record(
    [
        ("steering_tire_angle", "f8"),  # [rad]
        ("steering_tire_rotation_rate", "f8"),  # [rad/s]
        ("velocity", "f8"),  # [m/s]
        ("acceleration", "f8"),  # [m/s^2]
        ("jerk", "f8"),  # [m/s^3], in no frame
        ("is_defined_steering_tire_rotation_rate", "?"),
        ("is_defined_acceleration", "?"),
        ("is_defined_jerk", "?"),
    ]
)
"""The part of ``autoware_control_msgs/msg/Control`` that CAN carries."""

CAN_FRAME = record([("arbitration_id", "u4"), ("payload", "u1", (FRAME_BYTES,))])
"""One frame."""

CAN_FRAMES = record(
    [
        ("frame", CAN_FRAME, (len(FRAMES),)),
        ("rejected", "i4"),  # place in CAN_COMMAND of the value that has no encoding, -1: none
    ]
)
"""The frames of one command, in the order in which they are sent."""

_DONE = int(Encoding.DONE)
_NOT_FINITE = int(Encoding.NOT_FINITE)
_OUT_OF_RANGE = int(Encoding.OUT_OF_RANGE)
_NOT_USED = int(Encoding.NOT_USED)
_DDS_ONLY = int(OutputMode.DDS_ONLY)
_NS_PER_MS = 1_000_000
_IDS = tuple(frame.arbitration_id for frame in FRAMES)
_FRAMES = len(FRAMES)


def _row(name: str) -> tuple[int, int, int, int, int, int]:
    """Return a row of the table: index of the frame, first bit, bits, scale, least and most."""
    (found,) = (
        (index, signal.start_bit, signal.bits, signal.scale, signal.lowest, signal.highest)
        for index, frame in enumerate(FRAMES)
        for signal in frame.signals
        if signal.name == name
    )
    return found


_ANGLE = _row("steering_tire_angle")
_RATE = _row("steering_tire_rotation_rate")
_VELOCITY = _row("velocity")
_ACCELERATION = _row("acceleration")
_MODE = _row("mode")
_RATE_DEFINED = _row("steering_rate_defined")
_ACCELERATION_DEFINED = _row("acceleration_defined")
_JERK_DEFINED = _row("jerk_defined")
_FRAME_VALID = _row("frame_valid")
_SEQUENCE = _row("sequence")
_TIMESTAMP = _row("timestamp")

_NONE = -1
_JERK = CAN_COMMAND.names.index("jerk")


@kernel
def _clear(triple):
    """Give each frame its identifier and no bit."""
    triple.rejected = _NONE
    for index in range(_FRAMES):
        triple.frame[index].arbitration_id = _IDS[index]
        for byte in range(FRAME_BYTES):
            triple.frame[index].payload[byte] = 0


@kernel
def _put(triple, row, raw):
    """Write a whole number to the bits of a signal, lowest first; it counts modulo their number."""
    index, start_bit, bits, _, _, _ = row
    payload = triple.frame[index].payload
    first, shift = start_bit // 8, start_bit % 8
    shifted = (raw & ((1 << bits) - 1)) << shift
    for byte in range((shift + bits + 7) // 8):
        payload[first + byte] = payload[first + byte] | ((shifted >> (8 * byte)) & 0xFF)


@kernel
def _put_value(triple, row, value):
    """Write value x scale, rounded half away from zero; a value that does not fit is rejected.

    The product is formed in double precision, so it is exact for a value of single precision.
    """
    _, _, _, scale, lowest, highest = row
    if not math.isfinite(value):
        return _NOT_FINITE
    scaled = float(value) * scale
    if not lowest - 0.5 < scaled < highest + 0.5:  # what rounds to a number of so many bits
        return _OUT_OF_RANGE
    raw = int(scaled)
    rest = scaled - raw
    if rest >= 0.5:
        raw += 1
    elif rest <= -0.5:
        raw -= 1
    _put(triple, row, raw)
    return _DONE


@kernel
def _put_values(triple, command):
    """Write the four values; the first one that is rejected ends it."""
    values = (
        command.steering_tire_angle,
        command.steering_tire_rotation_rate,
        command.velocity,
        command.acceleration,
    )
    rows = (_ANGLE, _RATE, _VELOCITY, _ACCELERATION)
    for field in range(4):
        result = _put_value(triple, rows[field], values[field])
        if result != _DONE:
            triple.rejected = field
            return result
    return _DONE


@kernel
def _put_status(triple, command, mode, sequence, stamp_ns):
    """Write the third frame."""
    _put(triple, _MODE, mode)
    _put(triple, _RATE_DEFINED, int(command.is_defined_steering_tire_rotation_rate))
    _put(triple, _ACCELERATION_DEFINED, int(command.is_defined_acceleration))
    _put(triple, _JERK_DEFINED, int(command.is_defined_jerk))
    _put(triple, _FRAME_VALID, 1)
    _put(triple, _SEQUENCE, sequence)
    _put(triple, _TIMESTAMP, stamp_ns // _NS_PER_MS)


@entry(CAN_COMMAND, CAN_FRAMES, int, int, int)
def encode_frames(commands, triples, mode, sequence, stamp_ns):
    """Write the three frames of a command; return an Encoding.

    ``sequence`` counts modulo 65536; ``stamp_ns`` is the stamp of the command [ns], sent in whole
    milliseconds modulo 2^32. A value that is not finite or does not fit int32 rejects the command,
    and so does a jerk that is defined and not finite: then ``rejected`` names its field, and no
    frame may be sent.
    """
    command, triple = commands[0], triples[0]
    _clear(triple)
    if mode == _DDS_ONLY:
        return _NOT_USED
    if command.is_defined_jerk and not math.isfinite(command.jerk):
        triple.rejected = _JERK
        return _NOT_FINITE
    result = _put_values(triple, command)
    if result == _DONE:
        _put_status(triple, command, mode, sequence, stamp_ns)
    return result
