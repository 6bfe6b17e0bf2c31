# SPDX-License-Identifier: Apache-2.0
"""Random and hostile ticks through the kernels of this room: their bytes, one after the other.

As a program it prints the hash of all of them: compiled or plain, they are the same.
"""

from __future__ import annotations

import hashlib
import math
import random
from collections.abc import Iterator
from typing import Any

import numpy as np

from safety_island.command.can_frames import CAN_COMMAND, CAN_FRAMES, encode_frames
from safety_island.command.control_message import write_control
from safety_island.command.status_message import TICK, begin_status, write_status
from safety_island.control.records import COMMAND, TRACE
from safety_island.messages.fixed import FixedMessage
from safety_island.messages.outputs import CONTROL
from safety_island.messages.status import STATUS

TICKS = 400
HOSTILE = (0.0, -0.0, math.nan, math.inf, -math.inf, 5e-324, 2147.4836475, -2147483.6485, 0.0005)


class Drive:
    """The records of one island's outputs, and random ticks that fill them."""

    def __init__(self, seed: int) -> None:
        self._rng = random.Random(seed)
        self.command, self.trace = np.zeros(1, COMMAND), np.zeros(1, TRACE)
        self.tick, self.can_command = np.zeros(1, TICK), np.zeros(1, CAN_COMMAND)
        self.frames = np.zeros(1, CAN_FRAMES)
        self.control, self.status = FixedMessage(CONTROL), FixedMessage(STATUS)
        begin_status.bind(self.status.body)()
        records = self.tick, self.trace, self.command, self.status.body
        self._write_status = write_status.bind(*records)
        self._write_control = write_control.bind(self.command, self.control.body)
        self._encode = encode_frames.bind(self.can_command, self.frames)

    def step(self) -> bytes:
        """Do one tick; return what came of it."""
        rng = self._rng
        for records in (self.command, self.trace, self.tick, self.can_command):
            self._fill(records)
        status = self.status.body[0]
        status.state, status.missed_periods = rng.randrange(7), rng.randrange(3)
        offset_ns = rng.choice((rng.getrandbits(60), -rng.getrandbits(62)))
        sequence, stamp_ns = rng.randrange(70_000), rng.getrandbits(62) - 2**61
        results = (
            self._write_control(offset_ns),
            self._write_status(),
            self._encode(rng.randrange(3), sequence, stamp_ns),
        )
        data = self.control.to_bytes() + self.status.to_bytes() + self.frames.tobytes()
        return bytes(results) + data

    def _fill(self, records: Any) -> None:
        for name in records.dtype.names:
            kind = records.dtype[name]
            if not kind.shape:
                records[0][name] = self._value(kind)

    def _value(self, kind: Any) -> Any:
        rng = self._rng
        if kind.kind == "b":
            return rng.random() < 0.5
        if kind.kind != "f":
            return rng.randrange(256 if kind.itemsize < 8 else 2**61)
        if rng.random() < 0.2:
            return rng.choice(HOSTILE)
        return rng.uniform(-1.0, 1.0) * 10.0 ** rng.randrange(-3, 8)


def ticks(seed: int = 1) -> Iterator[bytes]:
    """Yield the bytes of each tick."""
    drive = Drive(seed)
    for _ in range(TICKS):
        yield drive.step()


def digest() -> str:
    """Return the hash of a drive."""
    return hashlib.sha256(b"".join(ticks())).hexdigest()


if __name__ == "__main__":
    print(digest())
