# SPDX-License-Identifier: Apache-2.0
"""The page docs/topics.md is what the table of topics says."""

from __future__ import annotations

from pathlib import Path

from safety_island.cli.topics_page import PAGE, main, render
from safety_island.dds.topics import DEBUG, OWN, TOPICS

ROOT = Path(__file__).parents[2]


def test_the_committed_page_is_current() -> None:
    again = "run: python -m safety_island.cli.topics_page"
    assert (ROOT / PAGE).read_text("utf-8") == render(), again


def test_every_topic_stands_on_it() -> None:
    page = render()
    assert all(f"`{entry.name}`<br>`{entry.type_name}`" in page for entry in (*TOPICS, *OWN))


def test_every_debug_topic_stands_on_it() -> None:
    page = render()
    assert all(
        f"| `{entry.name}` | `{entry.of_release('0.53').type_name}` |" in page for entry in DEBUG
    )


def test_it_is_written_where_it_is_asked_for(tmp_path: Path) -> None:
    main([str(tmp_path / "page.md")])
    assert (tmp_path / "page.md").read_text("utf-8") == render()
