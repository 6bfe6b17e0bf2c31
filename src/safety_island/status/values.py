# SPDX-License-Identifier: Apache-2.0
"""A status as named values, for JSON."""

from __future__ import annotations

import math
from enum import IntEnum
from typing import Any

from safety_island.command.mode import OutputMode
from safety_island.control.status import ControllerLimit, LongitudinalState, Mode, MpcStatus
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.warning import InputWarning
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.arm import ArmResult
from safety_island.messages.status_fields import InputStatus, Status
from safety_island.status.names import (
    flags_of,
    guard_limits_of,
    input_name,
    name_of,
    optional_name,
    verdict_of,
)

_ENUMS: dict[str, type[IntEnum]] = {
    "state": State,
    "reason": Reason,
    "latched_cause": Reason,
    "operation_mode": Mode,
    "longitudinal_state": LongitudinalState,
    "mpc_status": MpcStatus,
    "output_mode": OutputMode,
    "arm_result": ArmResult,
}
_KEYS = {
    "now": "now_ns",
    "memory": "memory_bytes",
    "tick_time": "tick_s",
    "lateral_time": "lateral_s",
    "longitudinal_time": "longitudinal_s",
    "lateness": "lateness_s",
    "sample_stamp": "sample_stamp_ns",
    "source_time": "source_time_ns",
    "age": "age_s",
    "age_limit": "age_limit_s",
    "transport_delay": "transport_delay_s",
    "command_angle": "steering_tire_angle",
    "command_rate": "steering_tire_rotation_rate",
    "command_velocity": "velocity",
    "command_acceleration": "acceleration",
}
"""Names that differ from the message's: with a unit, or as `island run --json` has them."""
SIGNIFICANT = 7
"""Digits of a number; a float32 has no more."""


def status_values(status: Status) -> dict[str, Any]:
    """Return a status; times in s, lengths in m, angles in rad, null for what has no value."""
    named = {
        "stamp": status.stamp._asdict(),
        "parameters_hash": f"{status.parameters_hash:016x}",
        "subject": input_name(status.subject),
        "controller_limits": flags_of(ControllerLimit, status.controller_limits),
        "guard_limits": guard_limits_of(status.guard_limits),
        "guard_verdict": verdict_of(status.guard_verdict),
        "inputs": {input_name(i): _input_values(item) for i, item in enumerate(status.inputs)},
    }
    for field, enum in _ENUMS.items():
        named[field] = optional_name(enum, getattr(status, field))
    return _renamed(status._asdict() | named)


def _input_values(item: InputStatus) -> dict[str, Any]:
    named = {
        "refused": {name_of(SampleReason, i): n for i, n in enumerate(item.refused) if n},
        "writer_guid": item.writer_guid.hex() if any(item.writer_guid) else None,
        "warnings": flags_of(InputWarning, item.warnings),
        "last_refusal": optional_name(SampleReason, item.last_refusal),
    }
    return _renamed(item._asdict() | named)


def _renamed(values: dict[str, Any]) -> dict[str, Any]:
    return {_KEYS.get(name, name): _number(value) for name, value in values.items()}


def _number(value: Any) -> Any:
    if not isinstance(value, float):
        return value
    return float(f"{value:.{SIGNIFICANT}g}") if math.isfinite(value) else None
