# SPDX-License-Identifier: Apache-2.0
"""Records of the life cycle: the tuples of Python and the parameters, field by field."""

from __future__ import annotations

from dataclasses import fields, replace

import pytest

from safety_island.errors import ConfigurationError
from safety_island.life_cycle.facts import Facts
from safety_island.life_cycle.limits import MAX_OVERRUN_WINDOW
from safety_island.life_cycle.params import LifeCycleParams, StopSteering
from safety_island.life_cycle.ramp import Motion
from safety_island.life_cycle.records import FACTS, LIFE, MOTION, OVERRUN, pack_life_params
from safety_island.life_cycle.transition import Life
from tests.life_cycle.parameters import PARAMETERS


@pytest.mark.parametrize("has_ramp", [False, True])
@pytest.mark.parametrize("steering", StopSteering)
def test_every_parameter_is_in_the_record(steering: StopSteering, has_ramp: bool) -> None:
    params = replace(PARAMETERS, stop_steering=steering.name.lower())
    packed = pack_life_params(params, 0.15, has_ramp)
    assert packed.shape == (1,)
    wanted = vars(params) | {"stop_steering": steering, "period_s": 0.15, "has_ramp": has_ramp}
    assert {name: packed[name][0] for name in wanted} == wanted
    assert set(packed.dtype.names or ()) == set(wanted)


def test_the_numbers_of_a_choice() -> None:
    assert [(item.name, int(item)) for item in StopSteering] == [("HOLD", 0), ("CENTRE", 1)]


def test_records_have_the_fields_of_the_tuples_in_their_order() -> None:
    assert FACTS.names == Facts._fields
    assert LIFE.names == Life._fields
    assert MOTION.names == Motion._fields


def test_the_window_may_be_as_long_as_its_memory_and_no_longer() -> None:
    longest = replace(PARAMETERS, overrun_window=MAX_OVERRUN_WINDOW)
    assert pack_life_params(longest, 0.15, False)[0].overrun_window == MAX_OVERRUN_WINDOW
    with pytest.raises(ConfigurationError, match=r"overrun_window is 1001, expected at most 1000"):
        pack_life_params(replace(PARAMETERS, overrun_window=1001), 0.15, False)
    assert OVERRUN["times"].shape == (MAX_OVERRUN_WINDOW + 1,)


def test_the_loader_allows_no_longer_window() -> None:
    (item,) = (item for item in fields(LifeCycleParams) if item.name == "overrun_window")
    assert item.metadata["high"] == MAX_OVERRUN_WINDOW
