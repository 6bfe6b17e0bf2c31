# SPDX-License-Identifier: Apache-2.0
"""The spellings of a frame."""

from __future__ import annotations

from safety_island.input_gate.frames import ANY_FRAME, frames


def test_with_and_without_a_slash() -> None:
    allowed = frames("map", "base_link")
    for name in ("map", "/map", "base_link", "/base_link"):
        assert name in allowed
    for name in ("", "/", "//map", "map/", "Map", "odom"):
        assert name not in allowed


def test_an_empty_name_allows_any() -> None:
    assert frames("map", "") is ANY_FRAME
    assert frames("") is ANY_FRAME
    assert "whatever" in ANY_FRAME and "" in ANY_FRAME
