"""From the trace of the controllers to the status: errors, solver, states, limits that acted."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from operator import itemgetter
from struct import Struct
from typing import Any

import numpy as np

from safety_island.control.records import Records
from safety_island.control.status import ControllerLimit
from safety_island.messages.fixed import letter
from safety_island.messages.status import StatusWriter

VALUES = {
    "lateral_error": "lateral_error",
    "yaw_error": "yaw_error",
    "residual": "residual",
    "stop_dist": "stop_dist",
    "target_vel": "target_vel",
    "solver_status": "solver_status",
    "solver_iterations": "solver_iterations",
    "active_constraints": "active_constraints",
    "longitudinal_state": "lon_state",
    "mpc_status": "mpc_status",
}
"""Field of the status -> field of TRACE; three runs of neighbours in the status."""
_ERRORS, _SOLVER = 5, 8
"""Where the first and the second run end."""

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


class TraceStatus:
    """Copies a TRACE record of shape (1,), always the same memory, into the status."""

    def __init__(self, trace: Records, writer: StatusWriter) -> None:
        names = tuple(VALUES)
        self._limits = writer.fields.controller_limits
        self._read_values = _reader(trace, list(VALUES.values()))
        self._read_flags = _reader(trace, list(FLAGS.values()))
        self._bits = [int(bit) for bit in FLAGS]
        self._write_errors = writer.pack(*names[:_ERRORS])
        self._write_solver = writer.pack(*names[_ERRORS:_SOLVER])
        self._write_states = writer.pack(*names[_SOLVER:])

    def fill(self) -> None:
        """Copy what the controllers did in this tick."""
        values = self._read_values()
        self._write_errors(*values[:_ERRORS])
        self._write_solver(*values[_ERRORS:_SOLVER])
        self._write_states(*values[_SOLVER:])
        limits = 0
        for bit, acts in zip(self._bits, self._read_flags(), strict=True):
            if acts:
                limits |= bit
        self._limits[0] = limits

    def clear(self) -> None:
        """Note that the controllers did not run in this tick: no limit acted, the rest stays."""
        self._limits[0] = 0


def _reader(trace: Records, names: list[str]) -> Callable[[], tuple[Any, ...]]:
    """Return a function that reads scalar fields of a record at once, in the order of the names."""
    fields: Any = trace.dtype.fields
    letters, end = "<", 0
    in_memory = sorted(names, key=lambda name: int(fields[name][1]))
    for name in in_memory:
        column, at = fields[name][:2]
        letters += f"{at - end}x{letter(column)}"
        end = at + column.itemsize
    read = partial(Struct(letters).unpack_from, trace.view(np.uint8).data)
    order = itemgetter(*(in_memory.index(name) for name in names))
    return lambda: order(read())
