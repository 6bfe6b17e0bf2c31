# SPDX-License-Identifier: Apache-2.0
"""The entries as C calls them: one record of each, and a status that says no more than it must."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from safety_island.life_cycle import island_watch, tick
from safety_island.life_cycle.life_cycle import LifeCycle
from safety_island.life_cycle.records import FACTS, ISLANDS, MOTION, PUBLISHERS, pack_life_params
from safety_island.life_cycle.state import LifeFlag
from tests.life_cycle.parameters import PARAMETERS

LIFE_CYCLE = LifeCycle(PARAMETERS, 0.125, True)
PARAMS, STATE = pack_life_params(PARAMETERS, 0.125, True), LIFE_CYCLE.memory
FOUND, COMMAND = np.zeros(1, FACTS), np.zeros(1, MOTION)
ISLANDS_OF_OTHERS, SEEN = np.zeros(1, ISLANDS), np.zeros(1, PUBLISHERS)


@pytest.mark.parametrize(
    "call",
    [
        tick.life_start.bind(PARAMS, STATE),
        lambda: tick.life_judge.bind(PARAMS, STATE, FOUND)(1.0),
        tick.life_fault.bind(PARAMS, STATE),
        lambda: tick.life_sent.bind(STATE, COMMAND)(1, 1.0),
        lambda: island_watch.islands_update.bind(np.zeros(1, ISLANDS), np.zeros(1, PUBLISHERS))(
            1.0
        ),
    ],
)
def test_what_has_nothing_to_say_returns_zero(call: Any) -> None:
    assert call() == 0


def test_all_memory_is_one_record() -> None:
    assert LIFE_CYCLE.memory.shape == (1,)


def test_flags_are_told_apart() -> None:
    assert [int(flag) for flag in LifeFlag] == [1, 2, 4]
