# SPDX-License-Identifier: Apache-2.0
"""Why a sample was refused: every reason of the decoder, the gate and the controllers' own check.

The table makes docs/status.md; the numbers are the places in ``refused`` of the status message.
"""

from __future__ import annotations

from enum import IntEnum

from safety_island.kernel.cdr import DecodeReason

GOOD = -1
"""In place of a reason: there is none."""


class SampleReason(IntEnum):
    """Reasons of a refusal."""

    ENCAPSULATION = DecodeReason.ENCAPSULATION
    TRUNCATED = DecodeReason.TRUNCATED
    LENGTH = DecodeReason.LENGTH
    STRING = DecodeReason.STRING
    BOOLEAN = DecodeReason.BOOLEAN
    TRAILING = DecodeReason.TRAILING
    NOT_FINITE = 6
    OUT_OF_RANGE = 7
    BAD_QUATERNION = 8
    TOO_FEW_POINTS = 9
    TOO_MANY_POINTS = 10
    COINCIDENT_POINTS = 11
    MIXED_DIRECTION = 12
    TOO_LONG = 13
    WRONG_FRAME = 14
    BAD_STAMP = 15
    DUPLICATE = 16
    STAMP_STANDS_STILL = 17
    OLDER = 18
    FROZEN = 19
    DELAYED = 20
    OTHER_PUBLISHER = 21
    FAULT = 22


UNUSABLE = frozenset(reason for reason in SampleReason if reason <= SampleReason.BAD_STAMP)
"""A new sample of the publisher came, and its bytes, its values or its points cannot be used."""

EXPLANATIONS: dict[SampleReason, tuple[str, str]] = {
    SampleReason.ENCAPSULATION: (
        "the first four bytes do not announce plain CDR (XCDR1)",
        "let the publisher use XCDR1, as ROS 2 does",
    ),
    SampleReason.TRUNCATED: ("the bytes end inside a field", "look for loss or a wrong type"),
    SampleReason.LENGTH: (
        "a string or sequence is longer than is taken",
        "shorten it; a trajectory may have 4096 points",
    ),
    SampleReason.STRING: ("a string is none", "look for a wrong type"),
    SampleReason.BOOLEAN: ("a boolean is neither 0 nor 1", "look for a wrong type"),
    SampleReason.TRAILING: ("more bytes follow than belong to it", "look for a wrong type"),
    SampleReason.NOT_FINITE: ("a used field is NaN or infinite", "mend its source"),
    SampleReason.OUT_OF_RANGE: ("a used field is beyond any sensible value", "mend its source"),
    SampleReason.BAD_QUATERNION: (
        "an orientation's norm is more than 1 % off",
        "normalise it at its source",
    ),
    SampleReason.TOO_FEW_POINTS: (
        "the trajectory has fewer points than `gate.min_trajectory_points`",
        "look at the planner",
    ),
    SampleReason.TOO_MANY_POINTS: ("the trajectory has more than 4096 points", "publish a part"),
    SampleReason.COINCIDENT_POINTS: (
        "all points of the trajectory are at one place",
        "nothing while the vehicle stands; else look at the planner",
    ),
    SampleReason.MIXED_DIRECTION: (
        "the points lead forward and backward along the trajectory, or their speeds do",
        "publish them in the order of driving, one direction at a time",
    ),
    SampleReason.TOO_LONG: ("the trajectory is longer than is resampled", "publish a part"),
    SampleReason.WRONG_FRAME: (
        "the frame is not that of the parameters",
        "transform it at its source, or set `gate.map_frame`, `gate.base_frame`",
    ),
    SampleReason.BAD_STAMP: (
        "the stamp is zero, negative, or no time",
        "let the publisher stamp its messages",
    ),
    SampleReason.DUPLICATE: ("the same bytes came before", "look for a second way or a replay"),
    SampleReason.STAMP_STANDS_STILL: (
        "its stamp is that of the sample before",
        "let the publisher stamp each message anew",
    ),
    SampleReason.OLDER: ("a newer sample came before", "look for reordering, or two clocks"),
    SampleReason.FROZEN: (
        "the vehicle moves, and its odometry repeats bit for bit",
        "look at the localization",
    ),
    SampleReason.DELAYED: (
        "it was under way for longer than the age limit",
        "look at the bridge and the network",
    ),
    SampleReason.OTHER_PUBLISHER: (
        "it is not from the publisher that the island keeps to",
        "stop the second publisher",
    ),
    SampleReason.FAULT: ("the island failed to judge it", "report it: a fault of the program"),
}
"""Reason -> what it means, what to do."""
