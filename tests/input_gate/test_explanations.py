# SPDX-License-Identifier: Apache-2.0
"""Every reason of the gate says what it means and what to do."""

from __future__ import annotations

from dataclasses import fields

import pytest

from safety_island.input_gate.params import GateParams
from safety_island.input_gate.reason import EXPLANATIONS, UNUSABLE, SampleReason

VERBS = (
    *("find", "fix", "let", "look", "mend", "normalise", "nothing", "publish", "report"),
    *("shorten", "stop", "transform"),
)


@pytest.mark.parametrize("reason", SampleReason)
def test_every_reason_is_explained(reason: SampleReason) -> None:
    meaning, action = EXPLANATIONS[reason]
    assert len(meaning) > 10 and len(action) > 10
    assert not meaning.endswith(".") and not action.endswith(".")
    assert is_advice(action) and not is_advice(meaning)


def is_advice(text: str) -> bool:
    """Whether it begins with what to do."""
    return text.split()[0].strip(";,") in VERBS


def test_only_what_came_and_cannot_be_used_is_unusable() -> None:
    """A planner that repeats itself, or is late, is not one whose trajectory cannot be followed."""
    usable = {
        *(SampleReason.DUPLICATE, SampleReason.STAMP_STANDS_STILL, SampleReason.OLDER),
        *(SampleReason.FROZEN, SampleReason.DELAYED, SampleReason.OTHER_PUBLISHER),
        SampleReason.FAULT,
    }
    assert set(SampleReason) - UNUSABLE == usable


def test_the_numbers_are_places_in_the_status_message() -> None:
    assert [int(reason) for reason in SampleReason] == list(range(len(SampleReason)))


@pytest.mark.parametrize("name", ["trajectory", "odometry", "steering", "acceleration"])
def test_every_input_that_ages_has_its_limit(name: str) -> None:
    (item,) = (item for item in fields(GateParams) if item.name == f"{name}_age_limit")
    assert item.metadata["key"] == f"gate.age_limit.{name}"
    assert item.metadata["unit"] == "s" and name in item.metadata["doc"]
