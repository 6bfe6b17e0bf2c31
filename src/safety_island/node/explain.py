"""Reasons in words, with the input that they are about."""

from __future__ import annotations

from safety_island.life_cycle.reason import EXPLANATIONS, Reason
from safety_island.node.inputs import INPUTS

_COMMAND = "the control command"


def subject_name(subject: int) -> str:
    """Return the name of an input; of none, that of the command."""
    return INPUTS[subject].name if subject < len(INPUTS) else _COMMAND


def explain(reason: Reason, subject: int) -> str:
    """Return what a reason means, for the input that it is about."""
    return EXPLANATIONS[reason].meaning.format(subject=subject_name(subject))
