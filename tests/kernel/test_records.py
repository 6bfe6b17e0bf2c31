# SPDX-License-Identifier: Apache-2.0
"""Records: how they are laid out, and their fields as cells that can be set."""

from __future__ import annotations

import numpy as np
import pytest

from safety_island.control.lateral_state import LATERAL_STATE
from safety_island.control.records import INPUTS, TRACE
from safety_island.kernel.records import cells, record

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


def test_records_within_records_are_laid_out_as_c_does() -> None:
    inner = record([("value", "f8"), ("flag", "?")])
    middle = record([("small", "u1"), ("rows", inner, (2,)), ("last", "?")])
    outer = record([("small", "u1"), ("middle", middle), ("inner", inner)])
    assert [inner.itemsize, middle.itemsize, outer.itemsize] == [16, 48, 72]
    assert [middle.fields[name][1] for name in middle.names] == [0, 8, 40]
    assert [outer.fields[name][1] for name in outer.names] == [0, 8, 56]
    found = np.zeros(1, outer)[0]
    found.middle.rows[1].value, found.inner.flag = 2.5, True
    assert found.middle.rows[1].value == 2.5 and found["inner"]["flag"]


def test_a_record_within_a_record_is_where_c_has_it() -> None:
    """NumPy alone would place it without regard to its alignment."""
    inner = record([("flag", "?"), ("number", "f8")])
    pair = record([("n", "i4"), ("inner", inner, (2,))])
    outer = record([("flag", "?"), ("inner", inner), ("pair", pair), ("last", "?")])
    assert [outer.fields[name][1] for name in outer.names] == [0, 8, 24, 64]
    assert [pair.fields[name][1] for name in pair.names] == [0, 8]
    assert (inner.itemsize, pair.itemsize, outer.itemsize) == (16, 40, 72)
    memory = np.zeros(1, outer)
    memory[0].pair.inner[1].number = 2.5
    assert memory["pair"]["inner"]["number"].tolist() == [[0.0, 2.5]]
