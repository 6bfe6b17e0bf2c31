# SPDX-License-Identifier: Apache-2.0
"""The numbers that belong to a reason."""

from __future__ import annotations

from collections.abc import Callable

from safety_island.command.mode import OutputMode
from safety_island.control.status import Mode, MpcStatus
from safety_island.life_cycle.reason import Reason
from safety_island.messages.status_fields import Status
from safety_island.status.names import guard_limits_of, name_of
from safety_island.status.reasons import explained
from safety_island.status.samples import oldest_input, subject_facts, subject_of


def facts(status: Status, reason: int) -> str:
    """Return the numbers to a reason, empty when there are none."""
    tell = _FACTS.get(reason)
    return tell(status) if tell else ""


def _latched(status: Status) -> str:
    if status.latched_cause in (Reason.NONE, Reason.LATCHED):
        return ""
    return f"it was: {explained(status, status.latched_cause).meaning}"


def _mode(status: Status) -> str:
    control = "enabled" if status.control_enabled else "not enabled"
    return f"it is {name_of(Mode, status.operation_mode)}, control is {control}"


def _writers(status: Status) -> str:
    item = subject_of(status)
    others = status.other_control_writers if item is None else item.other_writers
    return f"{others} beside the first" if others else ""


def _overrun(status: Status) -> str:
    return (
        f"{status.overruns} late in a row, {status.missed_periods_total} periods missed so far,"
        f" this tick took {status.tick_time * 1e3:.1f} ms"
    )


def _mpc(status: Status) -> str:
    return (
        f"{name_of(MpcStatus, status.mpc_status)}, lateral error {status.lateral_error:+.2f} m,"
        f" yaw error {status.yaw_error:+.2f} rad"
    )


def _tick_time(status: Status) -> str:
    return f"this tick took {status.tick_time * 1e3:.1f} ms"


def _guard(status: Status) -> str:
    limits = ", ".join(guard_limits_of(status.guard_limits)) or "no limit named"
    return f"{limits}; {status.guard_refused} refused so far"


def _output(status: Status) -> str:
    return f"{name_of(OutputMode, status.output_mode)}, {status.output_failures} failures so far"


def _foreign(status: Status) -> str:
    return f"{status.foreign_can_frames} since a second without one"


_FACTS: dict[int, Callable[[Status], str]] = {
    Reason.WAITING_FOR_INPUT: subject_facts,
    Reason.INPUT_STALE: subject_facts,
    Reason.PARTITION: oldest_input,
    Reason.NOT_AUTONOMOUS: _mode,
    Reason.WRITER_FLAPPING: _writers,
    Reason.SECOND_PUBLISHER: _writers,
    Reason.OVERRUN: _overrun,
    Reason.MPC_FAILED: _mpc,
    Reason.COMMAND_STALE: _tick_time,
    Reason.COMMAND_REFUSED: _guard,
    Reason.OUTPUT_FAILED: _output,
    Reason.LATCHED: _latched,
    Reason.SECOND_CAN_MASTER: _foreign,
}
