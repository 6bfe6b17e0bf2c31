# SPDX-License-Identifier: Apache-2.0
"""Every row has its test, and the page of rows is current."""

from __future__ import annotations

from tests.faults.table import FAULTS, PAGE, ROWS, by_row, page


def test_each_row_has_at_least_one_test() -> None:
    found = by_row()
    assert [row for row in ROWS if not found[row]] == []
    assert tuple(FAULTS) == ROWS


def test_the_page_is_current() -> None:
    """When this fails: .venv/bin/python -m tests.faults.table."""
    assert PAGE.read_text() == page()
