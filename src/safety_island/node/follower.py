# SPDX-License-Identifier: Apache-2.0
"""The trajectory follower as the node sees it: five inputs, two controllers, one command."""

from __future__ import annotations

from typing import Protocol

from safety_island.control.status import MpcStatus, Refusal
from safety_island.kernel.records import Records


class InputFollower(Protocol):
    """The side of the trajectory follower that takes inputs; each says why it refused one."""

    @property
    def incoming(self) -> Records:
        """Memory of POINT records that the next trajectory is decoded into."""

    @property
    def turned_points(self) -> int:
        """Orientations of the trajectory in force that contradicted it, and were replaced."""

    def offer_incoming(self, n: int, stamp: float, start: float = 0.0) -> Refusal:
        """Offer the first ``n`` points of ``incoming`` and their header stamp [s].

        ``start`` [s] is the time_from_start of the first point.
        """

    def offer_odometry(
        self,
        x: float,
        y: float,
        z: float,
        qx: float,
        qy: float,
        qz: float,
        qw: float,
        vx: float,
        vy: float,
        wz: float,
    ) -> Refusal:
        """Offer pose [m], velocity [m/s] and yaw rate [rad/s]."""

    def offer_steering(self, angle: float) -> Refusal:
        """Offer a tyre angle [rad]."""

    def offer_acceleration(self, ax: float) -> Refusal:
        """Offer an acceleration [m/s^2]."""

    def offer_operation_mode(self, mode: int, enabled: bool) -> Refusal:
        """Offer who drives."""


class Follower(InputFollower, Protocol):
    """The trajectory follower, as the node sees it; ``now`` is the monotonic clock [s]."""

    @property
    def command(self) -> Records:
        """COMMAND record, shape (1,), always the same memory; stamps on the clock of ``now``."""

    @property
    def trace(self) -> Records:
        """TRACE record, shape (1,), always the same memory."""

    def allow_control(self, allowed: bool) -> None:
        """Say whether commands are followed; if not, the controllers run as in manual mode."""

    def offer_steering_offset(self, offset: float) -> Refusal:
        """Offer the offset of the steering sensor [rad]; no tick waits for one."""

    def is_ready(self) -> bool:
        """Whether both controllers can run."""

    def run_lateral(self, now: float) -> MpcStatus:
        """Compute the steering side of the command; NO_REFERENCE leaves it alone."""

    def run_longitudinal(self, now: float) -> int:
        """Compute speed and acceleration of the command; negative when it is left alone."""

    def sync(self) -> None:
        """Hand each controller what it must know of the other at the next tick."""
