# SPDX-License-Identifier: Apache-2.0
"""The page docs/parameters.md is what the code says."""

from __future__ import annotations

from pathlib import Path

import pytest

from safety_island.params import SETS
from safety_island.params.document import main, render
from safety_island.params.no_effect import NO_EFFECT
from safety_island.params.schema import KNOWN

PAGE = Path(__file__).parents[2] / "docs" / "parameters.md"


def test_the_committed_page_is_current() -> None:
    again = "run: python -m safety_island.params.document"
    assert PAGE.read_text("utf-8") == render(), again


def test_every_key_and_set_stands_on_it() -> None:
    page = render()
    assert all(f"| `{key}` |" in page for key in [*KNOWN, *NO_EFFECT])
    assert all(f"| {name} " in page for name in SETS)


def test_it_is_written_where_it_is_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "new" / "page.md"
    main([str(path)])
    assert path.read_text("utf-8") == render()
    assert capsys.readouterr().out == f"wrote {path}\n"
