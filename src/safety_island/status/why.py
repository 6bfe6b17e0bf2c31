# SPDX-License-Identifier: Apache-2.0
"""One sentence: why nothing is being published, what holds the vehicle, or that all is well."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from safety_island.control.status import MpcStatus
from safety_island.dds.topics import CONTROL
from safety_island.life_cycle.reason import EXPLANATIONS, Explanation, Reason
from safety_island.life_cycle.state import State
from safety_island.messages.status import NO_VALUE
from safety_island.messages.status_fields import Status
from safety_island.status.domain import Domain
from safety_island.status.facts import facts
from safety_island.status.holds import holds, mpc_action
from safety_island.status.names import name_of
from safety_island.status.reasons import explained
from safety_island.status.samples import oldest_input, refusal_action, warned

_SENDING = (State.READY, State.ACTIVE)
_LEADS: dict[int, str] = {
    State.HOLD: "The last command is being repeated",
    State.STOP: "The stop ramp is being sent",
}


def flows(status: Status) -> bool:
    """Whether the controllers' commands are being published."""
    return status.state in _SENDING and status.published


def why(status: Status, before: Sequence[Status] = (), domain: Domain | None = None) -> str:
    """Return the sentence about a status.

    ``before``: those of the ticks before it, oldest first; ``domain``: what discovery knows of the
    publishers of the inputs. With either it may tell more.
    """
    if status.state not in _SENDING:
        lead = _LEADS.get(status.state, "Nothing is being published")
        return f"{lead}: {_because(status, status.reason, domain)}"
    if not status.published:
        return _missed(status, domain)
    return _flowing(status, [*before, status], domain)


def why_values(status: Status, before: Sequence[Status], domain: Domain | None) -> dict[str, Any]:
    """Return the same for JSON, with what it is made of."""
    return {
        "flows": flows(status),
        "free": is_free([*before, status]),
        "held_by": held_by([*before, status]),
        "why": why(status, before, domain),
    }


def held_by(statuses: Sequence[Status]) -> list[str]:
    """Return the names of what holds the vehicle although its commands are sent."""
    return [str(hold.reason) for hold in holds(statuses)]


def is_free(statuses: Sequence[Status]) -> bool:
    """Whether the vehicle is free to drive: only then all is well."""
    last = statuses[-1]
    return flows(last) and not _troubles(last, None) and not holds(statuses)


def _flowing(status: Status, statuses: Sequence[Status], domain: Domain | None) -> str:
    """Commands are sent: what is wrong all the same."""
    found = _troubles(status, domain)
    held = [Explanation(hold.meaning, hold.action) for hold in holds(statuses)]
    if not found and not held:
        return (
            f"All is well{warned(status)}: the island is {name_of(State, status.state)},"
            f" {status.commands} commands are sent, the last with {status.command_angle:+.3f} rad"
            f" and {status.command_acceleration:+.2f} m/s²; {oldest_input(status)}."
        )
    said = found or [f"Commands are sent, but {_said(held.pop(0))}"]
    return " ".join([*said, *(f"Also, {_said(more)}" for more in held)])


def _troubles(status: Status, domain: Domain | None) -> list[str]:
    """What the island itself says of a tick in which commands are sent; one sentence at most."""
    if status.degraded:
        return [f"Commands are sent, but {_because(status, Reason.OVERRUN, domain)}"]
    if status.reason != Reason.NONE:
        because = _because(status, status.reason, domain)
        return [because[0].upper() + because[1:]]
    if rivals := others(status):
        return [f"Commands are sent, but {rivals}; stop it, or the island."]
    return []


def _said(explanation: Explanation) -> str:
    return f"{explanation.meaning}; {explanation.action}."


def others(status: Status) -> str:
    """Return who else sends commands; empty when nobody does."""
    found = []
    if count := status.other_control_writers:
        who = "another publisher is" if count == 1 else f"{count} other publishers are"
        found.append(f"{who} on {CONTROL.name}")
    if status.foreign_can_frames:
        found.append(EXPLANATIONS[Reason.SECOND_CAN_MASTER].meaning)
    return ", and ".join(found)


def _missed(status: Status, domain: Domain | None) -> str:
    """No command in a state that sends them: a single tick that failed."""
    lead = f"No command went out in tick {status.tick}"
    if status.reason != Reason.NONE:
        return f"{lead}: {_because(status, status.reason, domain)}"
    return f"{lead}, though the island is {name_of(State, status.state)}; its log tells why."


def _because(status: Status, reason: int, domain: Domain | None) -> str:
    """What a reason means, the numbers to it, and what to do."""
    meaning, action = explained(status, reason)
    numbers = facts(status, reason)
    action = refusal_action(status, reason) or action
    if reason == Reason.MPC_FAILED and status.mpc_status not in (MpcStatus.SOLVED, NO_VALUE):
        action = mpc_action(status.mpc_status)
    if domain and (found := domain.explain(status, reason)):
        numbers = f"{numbers}; {found.meaning}" if numbers else found.meaning
        action = found.action
    return f"{meaning}{f' ({numbers})' if numbers else ''}; {action}."
