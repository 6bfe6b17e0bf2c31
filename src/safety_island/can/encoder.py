# SPDX-License-Identifier: Apache-2.0
"""The three frames of a command, as the kernel of ``command.can_frames`` encodes them."""

from __future__ import annotations

from functools import cache
from struct import Struct
from typing import NamedTuple

import numpy as np

from safety_island.can.command import Cause, Command
from safety_island.command.can_frames import CAN_COMMAND, CAN_FRAMES, encode_frames
from safety_island.command.encoding import Encoding
from safety_island.command.frames import FRAMES, STATUS, limits_text
from safety_island.command.mode import OutputMode
from safety_island.messages.fixed import layout
from safety_island.platform.interfaces import CanFrame

Triple = tuple[CanFrame, ...]
"""The three frames of a command in the order of ``FRAMES``; empty when the mode uses no CAN."""


class Rejection(NamedTuple):
    """Why no frame of a command exists: the first value that cannot be encoded."""

    arbitration_id: int
    signal: str
    value: float
    cause: Cause

    def describe(self) -> str:
        """Say what was found and what was expected."""
        if self.cause is Cause.NOT_FINITE:
            return f"{self.signal} is {self.value}, expected a finite number"
        allowed = limits_text(self.signal)
        return f"{self.signal} is {self.value:.10g}, expected {allowed} (int32 after scaling)"


class Encoder:
    """Memory for one command and its frames, and the kernel that goes from one to the other."""

    def __init__(self) -> None:
        command, frames = np.zeros(1, CAN_COMMAND), np.zeros(1, CAN_FRAMES)
        self._pack = Struct(f"={layout(CAN_COMMAND)}").pack_into
        self._command = command.view(np.uint8).data
        self._frames = frames
        self._payloads = frames[0].frame["payload"]
        self._encode = encode_frames.bind(command, frames)

    def encode(
        self, command: Command, mode: OutputMode, sequence: int, stamp_ns: int
    ) -> Triple | Rejection:
        """Return the frames of a command: three, none when the mode uses no CAN, or a rejection."""
        self._pack(self._command, 0, *command)
        result = self._encode(int(mode), sequence, stamp_ns)
        if result == Encoding.DONE:
            payloads = self._payloads
            return tuple(
                CanFrame(arbitration_id, payloads[index].tobytes())
                for index, arbitration_id in enumerate(_IDS)
            )
        return () if result == Encoding.NOT_USED else self._rejection(command, Encoding(result))

    def _rejection(self, command: Command, why: Encoding) -> Rejection:
        field = int(self._frames[0].rejected)
        name = CAN_COMMAND.names[field]
        return Rejection(
            _FRAME_OF.get(name, STATUS.arbitration_id), name, command[field], _CAUSES[why]
        )


_IDS = tuple(frame.arbitration_id for frame in FRAMES)
_FRAME_OF = {signal.name: frame.arbitration_id for frame in FRAMES for signal in frame.signals}
_CAUSES = {
    Encoding.NOT_FINITE: Cause.NOT_FINITE,
    Encoding.OUT_OF_RANGE: Cause.OUT_OF_RANGE,
}


@cache
def _encoder() -> Encoder:
    return Encoder()


def encode(command: Command, mode: OutputMode, sequence: int, stamp_ns: int) -> Triple | Rejection:
    """Return the frames of a command: three, none when the mode uses no CAN, or a rejection.

    ``sequence`` counts modulo 65536; ``stamp_ns`` is the stamp of the command [ns], sent in whole
    milliseconds modulo 2^32. A value that is not finite or does not fit int32 rejects the command
    before any frame exists; so does a jerk that is defined and not finite.
    """
    return _encoder().encode(command, mode, sequence, stamp_ns)
