# SPDX-License-Identifier: Apache-2.0
"""The tables of the documentation are those of the code."""

from __future__ import annotations

from safety_island.can.tables import TABLES, refresh
from tests.can.peers import ROOT

PAGE = ROOT / "docs/can.md"


def test_the_page_is_current() -> None:
    """When this fails: island can tables --update docs/can.md."""
    page = PAGE.read_text()
    assert refresh(page) == page
    for name in TABLES:
        assert f"<!-- table: {name} -->" in page


def test_a_stale_table_is_renewed_and_the_rest_is_left() -> None:
    page = "before\n<!-- table: modes -->\nold\n<!-- end -->\nafter\n"
    found = refresh(page)
    assert found == f"before\n<!-- table: modes -->\n{TABLES['modes']()}<!-- end -->\nafter\n"
    assert refresh(found) == found


def test_frames_with_bytes_scale_and_unit() -> None:
    table = TABLES["frames"]()
    assert (
        "| `0x100` | 4-7 | `steering_tire_rotation_rate` | int32 | x 1,000,000 | rad/s |" in table
    )
    assert "| `0x102` | 1, bit 3 | `frame_valid` | uint1 |" in table
    assert "| `0x102` | 2-3 | `sequence` | uint16 |" in table
