# SPDX-License-Identifier: Apache-2.0
"""Every reason of the life cycle says what it means and what to do."""

from __future__ import annotations

from dataclasses import fields

import pytest

from safety_island.life_cycle.params import LifeCycleParams
from safety_island.life_cycle.reason import EXPLANATIONS, Reason
from safety_island.life_cycle.state import State

VERBS = (
    *("engage", "find", "fix", "leave", "let", "look", "nothing", "publish", "read"),
    *("start", "stop", "take", "wait"),
)


@pytest.mark.parametrize("reason", Reason)
def test_every_reason_is_explained(reason: Reason) -> None:
    explanation = EXPLANATIONS[reason]
    assert explanation.meaning and explanation.action
    assert not explanation.meaning.endswith(".") and not explanation.action.endswith(".")
    assert is_advice(explanation.action) and not is_advice(explanation.meaning)


def is_advice(text: str) -> bool:
    """Whether it begins with what to do."""
    return text.split()[0].strip(";,") in VERBS


def test_the_numbers_are_those_of_the_status_message() -> None:
    assert [int(reason) for reason in Reason] == list(range(len(Reason)))
    assert [state.name for state in State] == ["INIT", "READY", "ACTIVE", "HOLD", "STOP", "SILENT"]
    assert [int(state) for state in State] == list(range(6))


def test_every_parameter_stands_under_the_name_of_the_room() -> None:
    assert all(item.metadata["key"].startswith("life_cycle.") for item in fields(LifeCycleParams))
