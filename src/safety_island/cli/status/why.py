"""One sentence: why nothing is being published, or that all is well."""

from __future__ import annotations

from safety_island.cli.status.facts import facts
from safety_island.cli.status.names import name_of
from safety_island.cli.status.reasons import explained
from safety_island.cli.status.samples import oldest_input, refusal_action, warned
from safety_island.dds.topics import CONTROL
from safety_island.life_cycle.reason import EXPLANATIONS, Reason
from safety_island.life_cycle.state import State
from safety_island.messages.status_fields import Status

_SENDING = (State.READY, State.ACTIVE)
_LEADS: dict[int, str] = {
    State.HOLD: "The last command is being repeated",
    State.STOP: "The stop ramp is being sent",
}


def flows(status: Status) -> bool:
    """Whether the controllers' commands are being published."""
    return status.state in _SENDING and status.published


def why(status: Status) -> str:
    """Return the sentence about a status."""
    if status.state not in _SENDING:
        lead = _LEADS.get(status.state, "Nothing is being published")
        return f"{lead}: {_because(status, status.reason)}"
    return _flowing(status) if status.published else _missed(status)


def _flowing(status: Status) -> str:
    if status.degraded:
        return f"Commands are sent, but {_because(status, Reason.OVERRUN)}"
    if status.reason != Reason.NONE:
        because = _because(status, status.reason)
        return because[0].upper() + because[1:]
    if rivals := others(status):
        return f"Commands are sent, but {rivals}; stop it, or the island."
    return (
        f"All is well{warned(status)}: the island is {name_of(State, status.state)},"
        f" {status.commands} commands are sent, the last with {status.command_angle:+.3f} rad and"
        f" {status.command_acceleration:+.2f} m/s²; {oldest_input(status)}."
    )


def others(status: Status) -> str:
    """Return who else sends commands; empty when nobody does."""
    found = []
    if count := status.other_control_writers:
        who = "another publisher is" if count == 1 else f"{count} other publishers are"
        found.append(f"{who} on {CONTROL.name}")
    if status.foreign_can_frames:
        found.append(EXPLANATIONS[Reason.SECOND_CAN_MASTER].meaning)
    return ", and ".join(found)


def _missed(status: Status) -> str:
    """No command in a state that sends them: a single tick that failed."""
    lead = f"No command went out in tick {status.tick}"
    if status.reason != Reason.NONE:
        return f"{lead}: {_because(status, status.reason)}"
    return f"{lead}, though the island is {name_of(State, status.state)}; its log tells why."


def _because(status: Status, reason: int) -> str:
    """What a reason means, the numbers to it, and what to do."""
    meaning, action = explained(status, reason)
    numbers = facts(status, reason)
    action = refusal_action(status, reason) or action
    return f"{meaning}{f' ({numbers})' if numbers else ''}; {action}."
