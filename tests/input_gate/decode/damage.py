# SPDX-License-Identifier: Apache-2.0
"""Bytes of the five inputs, whole and damaged, and what the kernels make of them.

As a program it prints a digest of both over many samples: compiled or plain, it is the same.
"""

from __future__ import annotations

import hashlib
import random
from collections.abc import Iterator

import numpy as np

from safety_island.control.records import new_points
from safety_island.input_gate.decode import inputs as kernels
from safety_island.input_gate.decode import records
from safety_island.input_gate.decode.records import BODY, MAX_SAMPLE, START, new_sample
from safety_island.input_gate.reason import GOOD
from safety_island.kernel.kernel import Entry
from safety_island.kernel.records import Records
from safety_island.messages import codec, inputs, trajectory
from tests.messages.oracle import rosbags_bytes
from tests.messages.samples import hot_messages

KERNELS: dict[str, tuple[Entry, Records]] = {
    trajectory.TRAJECTORY: (kernels.decode_trajectory, np.zeros(1, records.TRAJECTORY)),
    inputs.ODOMETRY: (kernels.decode_odometry, np.zeros(1, records.ODOMETRY)),
    inputs.STEERING: (kernels.decode_steering, np.zeros(1, records.STEERING)),
    inputs.ACCELERATION: (kernels.decode_acceleration, np.zeros(1, records.ACCELERATION)),
    inputs.OPERATION_MODE: (kernels.decode_operation_mode, np.zeros(1, records.OPERATION_MODE)),
}
"""Type -> the kernel that decodes it, and the record that it fills."""

SAMPLE = new_sample()
POINTS = new_points()


def put(data: bytes) -> None:
    """Put bytes into the memory that the kernels read."""
    SAMPLE["n_bytes"] = len(data)
    data = data if len(data) <= MAX_SAMPLE else data[: BODY - START]
    SAMPLE[0].bytes[START : START + len(data)] = np.frombuffer(data, np.uint8)


def decode(name: str, data: bytes) -> int:
    """Return what the kernels of a type say to these bytes."""
    kernel, filled = KERNELS[name]
    for one in (kernel, kernels.copy_points):
        one.prepare()
    put(data)
    reason = kernel.call(SAMPLE, filled)
    if reason == GOOD and name == trajectory.TRAJECTORY:
        reason = kernels.copy_points.call(SAMPLE, filled, POINTS)
    return reason


def whole() -> list[tuple[str, bytes]]:
    """Return a sample of each kind in both byte orders."""
    little = [(one.name, one.data) for one in hot_messages(4) if one.name in KERNELS]
    return little + [
        (name, rosbags_bytes(name, codec.decode(name, data), little_endian=False))
        for name, data in little
    ]


def damaged(seed: int, count: int) -> Iterator[tuple[str, bytes]]:
    """Yield samples with some bytes replaced, mostly in front, and some cut or too long."""
    dice = random.Random(seed)
    samples = whole()
    for _ in range(count):
        name, data = dice.choice(samples)
        bad = bytearray(data)
        for _ in range(dice.randrange(4)):
            at = dice.randrange(min(len(bad), dice.choice((8, 48, len(bad)))))
            bad[at] = dice.choice((0, 1, 2, 4, 0x7F, 0x80, 0xC3, 0xE0, 0xFF, dice.randrange(256)))
        end = dice.choice((len(bad), len(bad), dice.randrange(len(bad))))
        yield name, bytes(bad[:end]) + bytes(dice.choice((0, 0, 0, 3, 4)))


def digest(count: int) -> str:
    """Return a digest of every outcome and of every record that was filled."""
    found = hashlib.sha256()
    for name, data in damaged(1, count):
        reason = decode(name, data)
        found.update(f"{name} {reason} {SAMPLE[0].found}".encode())
        if reason == GOOD:
            found.update(KERNELS[name][1].tobytes() + POINTS[:4].tobytes())
    return found.hexdigest()


if __name__ == "__main__":
    print(digest(400))
