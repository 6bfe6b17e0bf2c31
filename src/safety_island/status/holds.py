# SPDX-License-Identifier: Apache-2.0
"""What keeps a vehicle from driving freely although commands are sent and autonomous mode is on.

The table makes docs/status.md and the sentences of ``island status --why``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import StrEnum
from typing import NamedTuple

from safety_island.control.status import ControllerLimit, LongitudinalState, MpcStatus
from safety_island.life_cycle.reason import Explanation
from safety_island.life_cycle.state import State
from safety_island.messages.status import NO_VALUE
from safety_island.messages.status_fields import Status
from safety_island.status.names import GUARD_LIMITS, guard_limits_of, name_of
from safety_island.status.reasons import plain

STANDSTILL = 0.01
"""Target speed [m/s] below which a trajectory asks to stand."""


class HoldReason(StrEnum):
    """What holds the vehicle; ``{...}`` in the table are fields of the status."""

    STEERING_NOT_CONVERGED = "STEERING_NOT_CONVERGED"
    STOP_POINT = "STOP_POINT"
    STOPPING = "STOPPING"
    FAR_FROM_TRAJECTORY = "FAR_FROM_TRAJECTORY"
    PAST_STOP_POINT = "PAST_STOP_POINT"
    EMERGENCY = "EMERGENCY"
    BRAKE_KEEPING = "BRAKE_KEEPING"
    TARGET_SPEED_ZERO = "TARGET_SPEED_ZERO"
    MPC_FAILED = "MPC_FAILED"
    GUARD = "GUARD"
    OUTPUT_FAILED = "OUTPUT_FAILED"


EXPLANATIONS: dict[HoldReason, Explanation] = {
    HoldReason.STEERING_NOT_CONVERGED: Explanation(
        "the brake of STOPPED ({command_acceleration:+.2f} m/s²) is kept until the steering has"
        " converged: measured and commanded angle ({command_angle:+.3f} rad) are further apart than"
        " `converged_steer_rad`, or the command or the end of the trajectory still moves",
        "look whether the vehicle's steering follows and its measurement is right, and whether the"
        " planner keeps the end of its trajectory; or set"
        " `enable_keep_stopped_until_steer_convergence: false`",
    ),
    HoldReason.STOP_POINT: Explanation(
        "the controller is STOPPED and brakes ({command_acceleration:+.2f} m/s²): the trajectory"
        " has its stop point {stop_dist:.2f} m ahead, not farther than `drive_state_stop_dist`",
        "nothing when the vehicle shall stand here; else look why the planner stops it",
    ),
    HoldReason.STOPPING: Explanation(
        "the controller is STOPPING ({command_acceleration:+.2f} m/s²): the trajectory has its stop"
        " point {stop_dist:.2f} m ahead",
        "nothing when the vehicle shall stop here; else look why the planner stops it",
    ),
    HoldReason.FAR_FROM_TRAJECTORY: Explanation(
        "the vehicle is farther from the trajectory than `emergency_state_traj_trans_dev` or"
        " `emergency_state_traj_rot_dev` (lateral error {lateral_error:+.2f} m, yaw error"
        " {yaw_error:+.2f} rad): the emergency brake ({command_acceleration:+.2f} m/s²) lasts until"
        " it is near",
        "publish a trajectory that begins at the vehicle; look at the localization",
    ),
    HoldReason.PAST_STOP_POINT: Explanation(
        "the controller is in EMERGENCY and brakes ({command_acceleration:+.2f} m/s²): the vehicle"
        " has passed the stop point (at {stop_dist:+.2f} m) by more than"
        " `emergency_state_overshoot_stop_dist`",
        "publish a trajectory that goes on from the vehicle; look whether the brake follows",
    ),
    HoldReason.EMERGENCY: Explanation(
        "the controller is in EMERGENCY and brakes ({command_acceleration:+.2f} m/s²): it was too"
        " far from the trajectory or past its stop point, and leaves that state at rest",
        "wait for standstill; if it lasts, leave autonomous mode and engage it again",
    ),
    HoldReason.BRAKE_KEEPING: Explanation(
        "a light brake ({command_acceleration:+.2f} m/s²) is kept up to the stop point"
        " {stop_dist:.2f} m ahead",
        "nothing when the vehicle shall stop here; else look why the planner stops it",
    ),
    HoldReason.TARGET_SPEED_ZERO: Explanation(
        "the trajectory asks for {target_vel:.3f} m/s where the vehicle is",
        "look why the planner plans no speed",
    ),
    HoldReason.MPC_FAILED: Explanation(
        "the MPC gives no new steering angle, and the last one is held: {state_of_the_MPC}"
        " (lateral error {lateral_error:+.2f} m, yaw error {yaw_error:+.2f} rad)",
        "{what_to_do_for_that_state}",
    ),
    HoldReason.GUARD: Explanation(
        "the guard changes commands ({clamped} of the last {commands}; {limits}):"
        " {what_that_means}",
        "{what_to_do_for_that_limit}",
    ),
    HoldReason.OUTPUT_FAILED: Explanation(
        "an output fails ({failures} failures in the last {commands} commands,"
        " {output_failures} so far)",
        "look at the CAN bus and the DDS domain; the log names the cause",
    ),
}

_TOO_FAR = "publish a trajectory that begins at the vehicle; look at the localization"
_MATRIX = "look at the weights of the MPC and the vehicle's dimensions in the parameters"
_SOLVER = (
    "look at the trajectory for a jump, and at `max_steer_angle` and the steering-rate limits;"
    " report it if it lasts"
)
MPC_EXPLANATIONS: dict[MpcStatus, Explanation] = {
    MpcStatus.SOLVED: Explanation("a new angle was found", "nothing"),
    MpcStatus.NO_REFERENCE: Explanation(
        "no trajectory has come that the MPC can follow",
        "publish a trajectory of at least three points",
    ),
    MpcStatus.TOO_FAR: Explanation(
        "the path is farther away than `admissible_position_error`", _TOO_FAR
    ),
    MpcStatus.YAW_ERROR_TOO_LARGE: Explanation(
        "the vehicle is turned away from the path by more than `admissible_yaw_error_rad`", _TOO_FAR
    ),
    MpcStatus.TRAJECTORY_TOO_SHORT: Explanation(
        "the trajectory ends before the horizon of the MPC does",
        "publish a longer trajectory, or set a shorter `min_prediction_length`",
    ),
    MpcStatus.INVALID_MATRIX: Explanation("the prediction is not finite", _MATRIX),
    MpcStatus.NOT_POSITIVE_DEFINITE: Explanation("the cost has no minimum", _MATRIX),
    MpcStatus.INFEASIBLE: Explanation("no angle keeps all limits", _SOLVER),
    MpcStatus.ITERATION_LIMIT: Explanation("the solver found no solution in time", _SOLVER),
    MpcStatus.SOLUTION_NOT_FINITE: Explanation("the solution is not finite", _SOLVER),
    MpcStatus.SOLUTION_VIOLATES: Explanation("the solution breaks a limit", _SOLVER),
    MpcStatus.SOLUTION_NOT_OPTIMAL: Explanation("the solution is not the optimum", _SOLVER),
    MpcStatus.SOLVER_ERROR: Explanation("the solver failed", _SOLVER),
}
"""Why there is no new steering angle, what to do."""


class Hold(NamedTuple):
    """One thing that holds the vehicle, in words."""

    reason: HoldReason
    meaning: str
    action: str


def holds(statuses: Sequence[Status]) -> list[Hold]:
    """Return what holds the vehicle as of the last status, the most severe first.

    The statuses are of ticks one after the other: what comes and goes with the ticks is looked for
    in all of them. Nothing holds one that is not ACTIVE: its reason says more.
    """
    last = statuses[-1]
    if last.state != State.ACTIVE or not last.published:
        return []
    return [_in_words(reason, statuses) for reason in _reasons(statuses)]


def _reasons(statuses: Sequence[Status]) -> Iterator[HoldReason]:
    last = statuses[-1]
    if longitudinal := _longitudinal(last):
        yield longitudinal
    if last.mpc_status not in (MpcStatus.SOLVED, NO_VALUE):
        yield HoldReason.MPC_FAILED
    if _clamped(statuses):
        yield HoldReason.GUARD
    if last.output_failures > statuses[0].output_failures:
        yield HoldReason.OUTPUT_FAILED


def _longitudinal(status: Status) -> HoldReason | None:
    """Return what the longitudinal controller brakes for; None when it drives."""
    limits = status.controller_limits
    if limits & ControllerLimit.FAR_FROM_TRAJECTORY:
        return HoldReason.FAR_FROM_TRAJECTORY
    if status.longitudinal_state == LongitudinalState.EMERGENCY:
        return HoldReason.PAST_STOP_POINT if status.stop_dist < 0.0 else HoldReason.EMERGENCY
    if status.longitudinal_state == LongitudinalState.STOPPING:
        return HoldReason.STOPPING
    if status.longitudinal_state == LongitudinalState.STOPPED:
        waits = limits & ControllerLimit.SLOW_START
        return HoldReason.STEERING_NOT_CONVERGED if waits else HoldReason.STOP_POINT
    if limits & ControllerLimit.BRAKE_KEEPING:
        return HoldReason.BRAKE_KEEPING
    return HoldReason.TARGET_SPEED_ZERO if abs(status.target_vel) < STANDSTILL else None


def _clamped(statuses: Sequence[Status]) -> list[int]:
    """Return the limits of each command that the guard changed."""
    return [status.guard_limits for status in statuses if status.guard_limits]


def _in_words(reason: HoldReason, statuses: Sequence[Status]) -> Hold:
    last = statuses[-1]
    words = last._asdict() | {
        "commands": len(statuses),
        "failures": last.output_failures - statuses[0].output_failures,
        "state_of_the_MPC": name_of(MpcStatus, last.mpc_status),
        "what_to_do_for_that_state": mpc_action(last.mpc_status),
        **_guard_words(_clamped(statuses)),
    }
    found = EXPLANATIONS[reason]
    return Hold(reason, *(plain(text.format_map(words)) for text in found))


def _guard_words(clamped: list[int]) -> dict[str, object]:
    bits = 0
    for limits in clamped:
        bits |= limits
    names = guard_limits_of(bits)
    known = [limit for limit in GUARD_LIMITS if limit & bits]
    meaning, action = GUARD_LIMITS[known[0]] if known else ("", "use the version of the island")
    return {
        "clamped": len(clamped),
        "limits": ", ".join(names),
        "what_that_means": meaning,
        "what_to_do_for_that_limit": action,
    }


def mpc_action(number: int) -> str:
    """Return what to do about a state of the MPC, which may be one of a newer island."""
    if number not in list(MpcStatus):
        return "use the version of the island"
    return plain(MPC_EXPLANATIONS[MpcStatus(number)].action)
