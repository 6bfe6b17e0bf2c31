# SPDX-License-Identifier: Apache-2.0
"""From the follower's record to the message, and what keeps a command from being sent."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.kernel.cdr import NANOSECONDS
from safety_island.life_cycle.ramp import Motion
from safety_island.messages.outputs import Control
from safety_island.messages.wire import Time


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

    def to_control(self, wall_offset_ns: int) -> Control:
        """Return the message, its stamps on the wall clock.

        The acceleration is always defined (the firmware leaves that flag unset), the jerk never.
        """
        stamp, longitudinal_stamp, angle, rate, velocity, acceleration, has_rate = self
        own = to_time(stamp, wall_offset_ns)
        other = own if longitudinal_stamp == stamp else to_time(longitudinal_stamp, wall_offset_ns)
        flags = (has_rate, True, False)
        message = (own, other, angle, rate, velocity, acceleration, 0.0, *flags, None)
        return tuple.__new__(Control, message)  # its own constructor takes twice as long


def substitute(motion: Motion, now: float) -> Computed:
    """Return a command of the life cycle as if the controllers had computed it at ``now`` [s]."""
    return Computed(now, now, *motion, is_defined_steering_tire_rotation_rate=True)


def to_time(monotonic_s: float, wall_offset_ns: int) -> Time:
    """Return the wall-clock stamp of a time on the monotonic clock [s]."""
    return tuple.__new__(Time, divmod(int(monotonic_s * 1e9) + wall_offset_ns, NANOSECONDS))
