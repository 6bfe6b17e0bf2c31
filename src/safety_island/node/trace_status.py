"""From the trace of the controllers to the status: errors, solver, states, limits that acted."""

from __future__ import annotations

from safety_island.control.records import Records
from safety_island.control.status import ControllerLimit
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


class TraceStatus:
    """Copies a TRACE record of shape (1,), always the same memory, into the status."""

    def __init__(self, trace: Records, writer: StatusWriter) -> None:
        fields = writer.fields
        self._limits = fields.controller_limits
        self._values = [(getattr(fields, to), trace[name].data) for to, name in VALUES.items()]
        self._flags = [(int(bit), trace[name].data) for bit, name in FLAGS.items()]

    def fill(self) -> None:
        """Copy what the controllers did in this tick."""
        for cell, view in self._values:
            cell[0] = view[0]
        bits = 0
        for bit, view in self._flags:
            if view[0]:
                bits |= bit
        self._limits[0] = bits

    def clear(self) -> None:
        """Note that the controllers did not run in this tick: no limit acted, the rest stays."""
        self._limits[0] = 0
