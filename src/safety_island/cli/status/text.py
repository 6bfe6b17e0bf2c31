# SPDX-License-Identifier: Apache-2.0
"""The figures of a status as texts, shared by the terminal view and the plain lines."""

from __future__ import annotations

import math

from safety_island.command.mode import OutputMode
from safety_island.control.status import ControllerLimit, LongitudinalState, Mode, MpcStatus
from safety_island.life_cycle.state import State
from safety_island.messages.arm import ArmResult
from safety_island.messages.status_fields import Status
from safety_island.status.names import (
    flags_of,
    guard_limits_of,
    name_of,
    optional_name,
    verdict_of,
)
from safety_island.status.why import flows, held_by, others, why
from safety_island.words import in_words


def duration(seconds: float) -> str:
    """Return a time in the unit that suits it; a dash when there is none."""
    if not math.isfinite(seconds):
        return "-"
    if abs(seconds) >= 1.0:
        return f"{seconds:.1f} s"
    return f"{seconds * 1e3:.2f} ms" if abs(seconds) < 0.01 else f"{seconds * 1e3:.0f} ms"


def command(status: Status) -> str:
    """Return the command that went out."""
    if math.isnan(status.command_angle):
        return "none went out in this tick"
    return (
        f"{status.command_angle:+.3f} rad, {status.command_rate:+.3f} rad/s,"
        f" {status.command_velocity:.2f} m/s, {status.command_acceleration:+.2f} m/s²"
    )


def output(status: Status) -> str:
    """Return where commands go, and how many went."""
    failed = f", {status.output_failures} failures" if status.output_failures else ""
    mode = name_of(OutputMode, status.output_mode)
    return f"{mode}, {status.commands} sent{failed}"


def controller(status: Status) -> str:
    """Return the state of both controllers."""
    mpc = optional_name(MpcStatus, status.mpc_status)
    if mpc is None:
        return "not run yet"
    state = optional_name(LongitudinalState, status.longitudinal_state) or "-"
    return (
        f"{state}, MPC {mpc}, {status.solver_iterations} iterations,"
        f" {status.active_constraints} active, residual {status.residual:.1e}"
    )


def errors(status: Status) -> str:
    """Return where the vehicle is, seen from the trajectory."""
    if math.isnan(status.lateral_error):
        return "-"
    return (
        f"lateral {status.lateral_error:+.3f} m, yaw {status.yaw_error:+.3f} rad,"
        f" stop in {status.stop_dist:.1f} m, target {status.target_vel:.2f} m/s"
    )


def limits(status: Status) -> str:
    """Return the limits that acted in the controllers."""
    return ", ".join(flags_of(ControllerLimit, status.controller_limits)) or "none acts"


def guard(status: Status) -> str:
    """Return what the guard did."""
    verdict = verdict_of(status.guard_verdict)
    acted = ", ".join(guard_limits_of(status.guard_limits))
    counts = f"{status.guard_clamped} clamped, {status.guard_refused} refused"
    return f"{verdict or 'not asked'}{f' ({acted})' if acted else ''}, {counts} so far"


def tick(status: Status) -> str:
    """Return the times of the tick."""
    return (
        f"#{status.tick} took {duration(status.tick_time)}"
        f" (lateral {duration(status.lateral_time)},"
        f" longitudinal {duration(status.longitudinal_time)})"
    )


def punctuality(status: Status) -> str:
    """Return how well the time grid is kept."""
    row = f", {status.overruns} late in a row" if status.overruns else ""
    return f"woken {duration(status.lateness)} late, {status.missed_periods_total} missed{row}"


def mode(status: Status) -> str:
    """Return who drives, and whether the island is armed."""
    control = "enabled" if status.control_enabled else "not enabled"
    asked = "" if status.arm_result == ArmResult.NONE else f", {_asked(status)}"
    armed = "armed" if status.armed else "not armed"
    return f"{name_of(Mode, status.operation_mode)}, control {control}; island {armed}{asked}"


def _asked(status: Status) -> str:
    result = in_words(name_of(ArmResult, status.arm_result))
    return f"asked to arm: {result}"


def plain_line(status: Status) -> str:
    """Return one line: the figures of a tick, or why there is no command."""
    head = f"{name_of(State, status.state):<6}  tick {status.tick}"
    if not flows(status):
        return f"{head}  {why(status)}"
    alarm = f"  {rivals}" if (rivals := others(status)) else ""
    alarm += "".join(f"  held: {name}" for name in held_by([status]))
    return (
        f"{head}  {command(status)}  lateral {status.lateral_error:+.3f} m"
        f"  {duration(status.tick_time)}{alarm}"
    )
