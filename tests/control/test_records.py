# SPDX-License-Identifier: Apache-2.0
"""Fields of a record as cells that can be set."""

from __future__ import annotations

import numpy as np
import pytest

from safety_island.control.lateral_state import LATERAL_STATE
from safety_island.control.records import INPUTS, TRACE
from safety_island.kernel.records import cells

NUMBERS = {"f": 1.5, "i": -3, "u": 3, "b": True}


@pytest.mark.parametrize("name", INPUTS.names)
def test_a_cell_is_the_field_and_no_other(name: str) -> None:
    records = np.zeros(1, INPUTS)
    cell = cells(records)[name]
    cell[0] = value = NUMBERS[INPUTS[name].kind]
    assert records[name][0] == cell[0] == value
    assert [other for other in INPUTS.names if records[other][0] != 0] == [name]


def test_arrays_and_records_within_it_have_none() -> None:
    found = cells(np.zeros(1, TRACE))
    assert set(TRACE.names) - set(found) == {"u"}
    assert not {"rx", "steering_filter"} & set(cells(np.zeros(1, LATERAL_STATE)))
