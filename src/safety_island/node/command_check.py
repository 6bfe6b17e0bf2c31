"""The last check before a command goes out, and what it says when one must not."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.life_cycle.reason import Reason
from safety_island.node.command import Computed
from safety_island.node.report import Outcome


class Checked(NamedTuple):
    """A command that may go out, or why not."""

    command: Computed | None
    refusal: Reason = Reason.NONE
    outcome: Outcome = Outcome.PUBLISHED
    detail: str = ""


def check(command: Computed, oldest: float) -> Checked:
    """Refuse what is stale (from before ``oldest`` [s, monotonic]) or not finite."""
    if side := command.stale_side(oldest):
        return Checked(None, Reason.COMMAND_STALE, Outcome.STALE, side)
    if not command.is_finite():
        return Checked(None, Reason.COMMAND_REFUSED, Outcome.NOT_FINITE, "command")
    return Checked(command)
