# SPDX-License-Identifier: Apache-2.0
"""The page docs/guard.md is what the guard's code says."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

from safety_island.cli.guard_page import PAGE, main, name_of, render
from safety_island.guard import GuardParams, Limit
from safety_island.parameter import key_of

ROOT = Path(__file__).parents[2]


def test_the_committed_page_is_current() -> None:
    again = "run: python -m safety_island.cli.guard_page"
    assert (ROOT / PAGE).read_text("utf-8") == render(), again


def test_every_check_and_limit_stands_on_it() -> None:
    page = render()
    assert all(f"| {limit.value} | {name_of(limit)} |" in page for limit in Limit)
    assert all(f"| `{key_of(item)}` |" in page for item in fields(GuardParams))


def test_it_is_written_where_it_is_asked_for(tmp_path: Path) -> None:
    main([str(tmp_path / "page.md")])
    assert (tmp_path / "page.md").read_text("utf-8") == render()
