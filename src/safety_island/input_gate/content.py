# SPDX-License-Identifier: Apache-2.0
"""What a decoded sample must say beyond single values: its frame, its length, that it lives."""

from __future__ import annotations

from collections.abc import Sized
from typing import Protocol

from safety_island.input_gate.frames import frames
from safety_island.input_gate.params import GateParams
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.stamps import StampGate


class Framed(Protocol):
    """A message in a frame."""

    @property
    def frame_id(self) -> str:
        """Name of the frame."""


class Path(Framed, Protocol):
    """A trajectory."""

    @property
    def points(self) -> Sized:
        """Its points."""


class Motion(Framed, Protocol):
    """Odometry."""

    @property
    def child_frame_id(self) -> str:
        """Frame of the velocity."""

    @property
    def vx(self) -> float:
        """Speed along body x [m/s]."""


class ContentGate:
    """One check for each kind of message: why it is refused, None when it may pass."""

    def __init__(self, params: GateParams) -> None:
        self._map = frames(params.map_frame)
        self._base = frames(params.base_frame)
        self._either = frames(params.map_frame, params.base_frame)
        self._fewest_points = params.min_trajectory_points
        self._moving_speed = params.moving_speed

    def trajectory(self, message: Path, data: bytes, stamps: StampGate) -> SampleReason | None:
        """Judge frame and number of points."""
        if message.frame_id not in self._map:
            return SampleReason.WRONG_FRAME
        return SampleReason.TOO_FEW_POINTS if len(message.points) < self._fewest_points else None

    def odometry(self, message: Motion, data: bytes, stamps: StampGate) -> SampleReason | None:
        """Judge both frames; a vehicle that moves cannot repeat its odometry bit for bit."""
        if message.frame_id not in self._map or message.child_frame_id not in self._base:
            return SampleReason.WRONG_FRAME
        if abs(message.vx) >= self._moving_speed and stamps.repeats(data):
            return SampleReason.FROZEN
        return None

    def acceleration(self, message: Framed, data: bytes, stamps: StampGate) -> SampleReason | None:
        """Judge the frame: Autoware's localization names the map here, its simulator the body."""
        return None if message.frame_id in self._either else SampleReason.WRONG_FRAME
