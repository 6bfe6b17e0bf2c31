# SPDX-License-Identifier: Apache-2.0
"""The statuses of the topic /diagnostics, by the names that Autoware's monitors know."""

from __future__ import annotations

import math
from typing import Any

from safety_island.control.params import Parameters
from safety_island.control.release import RELEASES
from safety_island.control.status import LongitudinalState, MpcStatus
from safety_island.messages.debug import Diagnostic

_NODE = "controller_node_exe"
_HARDWARE = "trajectory_follower_node"
_CYCLIC_SINCE = RELEASES.index("0.51")
_DEVIATIONS_UNTIL = RELEASES.index("0.40")

_GETTING_DATA = {
    MpcStatus.TOO_FAR: "too large position error",
    MpcStatus.YAW_ERROR_TOO_LARGE: "too large yaw error",
    MpcStatus.TRAJECTORY_TOO_SHORT: "path is too short for prediction.",
}
_OPTIMISING = {
    MpcStatus.INVALID_MATRIX: "invalid model matrix",
    MpcStatus.SOLUTION_NOT_FINITE: "model Uex including NaN",
}


def diagnostics(parameters: Parameters, trace: Any, trajectory_age_s: float) -> list[Diagnostic]:
    """Return the statuses after a tick; ``trajectory_age_s`` is inf when none ever came."""
    found = [mpc_solve_checker(MpcStatus(int(trace.mpc_status))), control_state(parameters, trace)]
    if RELEASES.index(parameters.node.autoware_release) >= _CYCLIC_SINCE:
        limit_s = parameters.node.cyclic_message_timeout_thr_sec
        found.append(cyclic_message_timeout(trajectory_age_s, limit_s))
    return found


def _status(name: str, message: str, is_error: bool, *values: tuple[str, str]) -> Diagnostic:
    return Diagnostic(f"{_NODE}: {name}", message, is_error, values, _HARDWARE)


def mpc_solve_checker(status: MpcStatus) -> Diagnostic:
    """Whether the MPC found a steering angle; before it ran, that is no error."""
    if status in (MpcStatus.SOLVED, MpcStatus.NO_REFERENCE):
        return _status("MPC_solve_checker", "MPC succeeded.", False)
    if status in _GETTING_DATA:
        reason = f"getting MPC Data ({_GETTING_DATA[status]})."
    else:
        reason = f"optimization failure ({_OPTIMISING.get(status, 'qp solver error')})."
    return _status("MPC_solve_checker", f"MPC failed due to {reason}", True)


def control_state(parameters: Parameters, trace: Any) -> Diagnostic:
    """The longitudinal state, an error only in EMERGENCY; until 0.40 with the deviations."""
    state, longitudinal = LongitudinalState(int(trace.lon_state)), parameters.longitudinal
    is_emergency = state is LongitudinalState.EMERGENCY
    message = "emergency occurred due to " if is_emergency else "OK"
    values = [("control_state", str(int(state)))]
    if RELEASES.index(parameters.node.autoware_release) <= _DEVIATIONS_UNTIL:
        for name, limit, value in (
            ("translation", longitudinal.emergency_state_traj_trans_dev, float(trace.trans_dev)),
            ("rotation", longitudinal.emergency_state_traj_rot_dev, float(trace.rot_dev)),
        ):
            message += f"{name} deviation" if value > limit else ""
            values += [(f"{name} deviation threshold", f"{limit:f}")]
            values += [(f"{name} deviation", f"{value:f}")]
    return _status("control_state", message, is_emergency, *values)


def cyclic_message_timeout(age_s: float, limit_s: float) -> Diagnostic:
    """Whether trajectories keep coming; it ends no output."""
    name = "cyclic_message_timeout"
    if math.isinf(age_s):
        return _status(name, "no message received", True)
    if age_s > limit_s:
        return _status(name, f"no trajectory for {age_s:.2f} s, at most {limit_s:g} s", True)
    return _status(name, "OK", False)
