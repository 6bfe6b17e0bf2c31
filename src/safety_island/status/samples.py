# SPDX-License-Identifier: Apache-2.0
"""What the status tells of the inputs, in words."""

from __future__ import annotations

import math

from safety_island.input_gate.warning import InputWarning
from safety_island.life_cycle.reason import Reason
from safety_island.messages.status_fields import InputStatus, Status
from safety_island.status.names import flags_of, input_name
from safety_island.status.reasons import explained_refusal

_BY_SAMPLES = (Reason.WAITING_FOR_INPUT, Reason.INPUT_STALE)


def subject_of(status: Status) -> InputStatus | None:
    """Return the input that the reason is about."""
    return status.inputs[status.subject] if status.subject < len(status.inputs) else None


def subject_facts(status: Status) -> str:
    """Return age and refusals of the input that the reason is about."""
    item = subject_of(status)
    if item is None:
        return ""
    parts = [_age(item)]
    if item.refused_in_a_row:
        one = item.refused_in_a_row == 1
        count = "1 sample was" if one else f"the last {item.refused_in_a_row} samples were"
        parts.append(f"{count} refused: {explained_refusal(item.last_refusal)[0]}")
    elif not item.received:
        parts.append("none received")
    return "; ".join(parts)


def refusal_action(status: Status, reason: int) -> str:
    """Return what to do about samples that come and are refused; empty when none are."""
    item = subject_of(status)
    if item is None or reason not in _BY_SAMPLES or not item.refused_in_a_row:
        return ""
    return explained_refusal(item.last_refusal)[1]


def oldest_input(status: Status) -> str:
    """Name the oldest of the inputs that have an age limit, and its age."""
    ages = [(item.age, i) for i, item in enumerate(status.inputs) if item.age_limit < math.inf]
    if not ages:
        return "no input has an age limit"
    age, place = max(ages)
    return f"the oldest input is {input_name(place)} ({age:.2f} s)"


def warned(status: Status) -> str:
    """Name the inputs that are warned of, after a comma; empty when none is."""
    found = [
        f"{input_name(place)} ({', '.join(flags_of(InputWarning, item.warnings))})"
        for place, item in enumerate(status.inputs)
        if item.warnings
    ]
    return f", with a warning of {', '.join(found)}" if found else ""


def _age(item: InputStatus) -> str:
    if math.isinf(item.age):
        return "never accepted"
    limit = "" if math.isinf(item.age_limit) else f", limit {item.age_limit:.2f} s"
    return f"{item.age:.2f} s{limit}"
