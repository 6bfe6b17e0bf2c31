# SPDX-License-Identifier: Apache-2.0
"""Reasons in words, with the input that they are about."""

from __future__ import annotations

from safety_island.life_cycle.reason import EXPLANATIONS, Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Life
from safety_island.node.inputs import INPUTS
from safety_island.platform.interfaces import Logger

_ALARMING = (State.HOLD, State.STOP, State.SILENT)
_COMMAND = "the control command"


def subject_name(subject: int) -> str:
    """Return the name of an input; of none, that of the command."""
    return INPUTS[subject].name if subject < len(INPUTS) else _COMMAND


def explain(reason: Reason, subject: int) -> str:
    """Return what a reason means, for the input that it is about."""
    return EXPLANATIONS[reason].meaning.format(subject=subject_name(subject))


def tell_state(logger: Logger, life: Life, subject: int) -> None:
    """Log a change of state; one that comes and goes is told now and then."""
    state, meaning = life.state.name, explain(life.reason, subject)
    log = logger.warning if life.state in _ALARMING else logger.info
    log("state %s: %s", state, meaning, throttled=True, site=f"{state} {life.reason.name}")
