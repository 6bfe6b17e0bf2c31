# SPDX-License-Identifier: Apache-2.0
"""From the trace of the controllers to the status: errors, solver, states, limits that acted."""

from __future__ import annotations

import math
from functools import cache
from itertools import compress
from typing import NamedTuple

import numpy as np

from safety_island.control.records import TRACE
from safety_island.control.status import ControllerLimit
from safety_island.kernel.records import Records
from safety_island.messages.fixed import reader
from safety_island.messages.status import NO_VALUE

ERRORS = ("lateral_error", "yaw_error", "residual", "stop_dist", "target_vel")
SOLVER = ("solver_status", "solver_iterations", "active_constraints")
STATES = ("longitudinal_state", "mpc_status")
"""Fields of the status that are copied from a field of TRACE; each line of neighbours."""
COLUMNS = {name: name for name in (*ERRORS, *SOLVER, *STATES)} | {"longitudinal_state": "lon_state"}
"""Field of the status -> field of TRACE."""

FLAGS = {
    ControllerLimit.STEERING_ANGLE: "angle_limited",
    ControllerLimit.STEERING_RATE: "rate_limited",
    ControllerLimit.STEERING_HELD: "stopped",
    ControllerLimit.ACCELERATION: "acc_limited",
    ControllerLimit.JERK: "jerk_limited",
    ControllerLimit.COMMAND_DIFFERENCE: "diff_limited",
    ControllerLimit.PITCH: "pitch_limited",
    ControllerLimit.SLOW_START: "slow_start_held",
    ControllerLimit.BRAKE_KEEPING: "brake_keeping",
    ControllerLimit.FAR_FROM_TRAJECTORY: "far_from_trajectory",
    ControllerLimit.STUCK_IN_EMERGENCY: "stuck_in_emergency",
}
"""Bit of the status -> flag of TRACE."""


@cache
def _limits(flags: bytes) -> int:
    """Return the bits of ControllerLimit; there are few combinations, told again and again."""
    return sum(compress(map(int, FLAGS), flags))


class Traced(NamedTuple):
    """What the trace says, in the words of the status."""

    errors: tuple[float, ...] = (math.nan,) * len(ERRORS)
    solver: tuple[int, ...] = (0,) * len(SOLVER)
    states: tuple[int, ...] = (NO_VALUE,) * len(STATES)
    limits: int = 0
    """Bits of ControllerLimit."""


class TraceStatus:
    """Reads a TRACE record of shape (1,), always the same memory; ``last`` is what it said."""

    def __init__(self, trace: Records) -> None:
        self.last = Traced()
        self._read = reader(trace, *COLUMNS.values())
        self._flags = trace.view(np.uint8).data[_FLAGS]

    def read(self) -> None:
        """Take what the controllers did in this tick."""
        values, limits = self._read(), _limits(self._flags.tobytes())
        parts = values[:_SOLVER], values[_SOLVER:_STATES], values[_STATES:]
        self.last = tuple.__new__(Traced, (*parts, limits))

    def clear(self) -> None:
        """Note that the controllers did not run in this tick: no limit acted, the rest stays."""
        if self.last.limits:
            self.last = self.last._replace(limits=0)


_SOLVER = len(ERRORS)
_STATES = _SOLVER + len(SOLVER)
"""Places in what is read."""

_FIRST = TRACE.fields[next(iter(FLAGS.values()))][1]
_FLAGS = slice(_FIRST, _FIRST + len(FLAGS))
"""Where TRACE has the flags: they are neighbours there, in this order."""
