# SPDX-License-Identifier: Apache-2.0
"""The follower's record as numbers, and what keeps a command from being sent."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.life_cycle.ramp import Motion


class Computed(NamedTuple):
    """One COMMAND record as Python numbers, field by field; stamps on the monotonic clock [s]."""

    stamp: float
    longitudinal_stamp: float
    steering_tire_angle: float
    steering_tire_rotation_rate: float
    velocity: float
    acceleration: float
    is_defined_steering_tire_rotation_rate: bool

    def with_values(self, values: tuple[float, ...]) -> Computed:
        """Return it with other values: angle, rate, velocity, acceleration."""
        return Computed._make((self.stamp, self.longitudinal_stamp, *values, self[-1]))

    def stale_side(self, oldest: float) -> str:
        """Name the controller whose result is from before ``oldest`` [s]; empty when none is."""
        if not self.stamp >= oldest:
            return "lateral"
        return "" if self.longitudinal_stamp >= oldest else "longitudinal"


def substitute(motion: Motion, now: float) -> Computed:
    """Return a command of the life cycle as if the controllers had computed it at ``now`` [s]."""
    return Computed(now, now, *motion, is_defined_steering_tire_rotation_rate=True)
