# SPDX-License-Identifier: Apache-2.0
"""Puts the frames of one command together again."""

from __future__ import annotations

from enum import StrEnum

from safety_island.can.decoder import Decoded, Fault, decode
from safety_island.command.frames import COMMAND_IDS, FRAMES
from safety_island.platform.interfaces import CanFrame

_ORDER = tuple(frame.arbitration_id for frame in FRAMES)


class Progress(StrEnum):
    """What a frame did to the triple in hand when it did not end it."""

    UNRELATED = "unrelated"
    """Not a frame of a command."""
    PENDING = "pending"
    """The triple lacks frames that come later."""
    TORN = "torn"
    """A frame is missing: the frames so far are of no use."""
    STRAY = "stray"
    """One more frame of a triple that is known to be torn, or that began before we listened."""
    SPREAD = "spread"
    """The frames came too far apart to be one command: the first two carry no counter."""


class TripleAssembler:
    """Accepts the frames of a command only complete, in order, and close together.

    ``window_s``: the time that the first and the last frame of a command may lie apart. Half a
    period is a good value: mixing frames of two commands would need a whole one.
    """

    def __init__(self, window_s: float) -> None:
        self.window_s = window_s
        self._frames: list[CanFrame] = []
        self._begun_s = 0.0
        self._is_between = True

    def feed(self, frame: CanFrame, time_s: float) -> Decoded | Fault | Progress:
        """Take the next frame of the bus, received at ``time_s``; return what it led to."""
        if frame.arbitration_id not in COMMAND_IDS:
            return Progress.UNRELATED
        if frame.arbitration_id == _ORDER[0]:
            return self._begin(frame, time_s)
        if not self._frames:
            return Progress.STRAY if self._is_between else self._drop(Progress.TORN)
        if frame.arbitration_id != _ORDER[len(self._frames)]:
            return self._drop(Progress.TORN)
        if not 0.0 <= time_s - self._begun_s <= self.window_s:
            return self._drop(Progress.SPREAD)
        self._frames.append(frame)
        if len(self._frames) < len(_ORDER):
            return Progress.PENDING
        frames, self._frames = self._frames, []
        return decode(frames)

    def _begin(self, frame: CanFrame, time_s: float) -> Progress:
        was_torn = bool(self._frames)
        self._frames, self._begun_s, self._is_between = [frame], time_s, False
        return Progress.TORN if was_torn else Progress.PENDING

    def _drop(self, reason: Progress) -> Progress:
        self._frames = []
        self._is_between = True
        return reason
