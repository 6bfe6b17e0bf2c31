# SPDX-License-Identifier: Apache-2.0
"""The usual command, told at little cost: one that keeps every limit, whatever the speed in detail.

What this does not pass is judged in full; so it may ask for more than the limits do, never less
(but for the last bit of a sum).
"""

from __future__ import annotations

from safety_island.guard.proposal import Proposal
from safety_island.guard.table import SpeedTable

Sent = tuple[float, float, float, float]
"""Of a command that was let through: when [s], angle [rad], its tangent, acceleration [m/s^2]."""


class Shortcut:
    """Knows the limits of a vehicle: by speed, its highest speed [m/s], its wheel base [m]."""

    def __init__(self, table: SpeedTable, fastest: float, wheel_base: float) -> None:
        self._strictest = table.strictest
        self._fastest, self._wheel_base = fastest, wheel_base

    def keeps_all(
        self,
        proposal: Proposal,
        slope: float,
        sent: Sent,
        speed: float,
        steering: float,
        step: float,
    ) -> bool:
        """Whether a command keeps all limits, those that count from the one ``sent`` before too.

        ``slope`` is the tangent of its angle, ``step`` [s] the time since; speed [m/s] and steering
        [rad] as measured. The lateral limits are those of the bicycle model, without slip.
        """
        _, _, _, angle, rotation, velocity, push = proposal
        _, angle_before, slope_before, push_before = sent
        limits = self._strictest(abs(speed))
        largest, rate, rotation_rate, distance, lateral, jerk, drive, brake, rise, fall = limits
        turn, square, fastest = rate * step, speed * speed, self._fastest
        return (
            -turn <= angle - angle_before <= turn
            and -largest <= angle <= largest
            and -distance <= angle - steering <= distance
            and abs(slope) * square <= lateral * self._wheel_base
            and abs(slope - slope_before) * square <= jerk * step * self._wheel_base
            and -rotation_rate <= rotation <= rotation_rate
            and -brake <= push <= drive
            and -fall * step <= push - push_before <= rise * step
            and -fastest <= velocity <= fastest
            and -fastest <= speed <= fastest
            and speed * velocity >= 0.0
        )
