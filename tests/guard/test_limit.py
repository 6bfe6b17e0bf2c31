# SPDX-License-Identifier: Apache-2.0
"""The bits and the texts of the guard's checks."""

from __future__ import annotations

import pytest

from safety_island.guard import EXPLANATIONS, Limit, Verdict
from safety_island.guard.limit import REFUSALS


def test_the_numbers_of_the_status_message() -> None:
    """They stand in recordings: changing one changes what those say."""
    assert [limit.value for limit in Limit] == [1 << i for i in range(12)]
    assert [limit.name for limit in Limit] == [
        *("ANGLE", "RATE", "ROTATION_RATE", "STEERING_DISTANCE"),
        *("LATERAL_ACCELERATION", "LATERAL_JERK", "ACCELERATION", "JERK", "VELOCITY"),
        *("NOT_FINITE", "STALE", "SEQUENCE"),
    ]
    assert [(v.name, v.value) for v in Verdict] == [("PASSED", 0), ("CLAMPED", 1), ("REFUSED", 2)]
    assert REFUSALS == Limit.NOT_FINITE | Limit.STALE | Limit.SEQUENCE


@pytest.mark.parametrize("limit", Limit)
def test_every_check_is_explained(limit: Limit) -> None:
    meaning, action = EXPLANATIONS[limit]
    assert len(meaning) > 10 and len(action) > 10
    assert not meaning.endswith(".") and not action.endswith(".")
