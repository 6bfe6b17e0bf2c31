# SPDX-License-Identifier: Apache-2.0
"""docs/autoware-map.md names files and functions that are there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "src/safety_island"
ROWS = [
    row.split(" | ")
    for row in (ROOT / "docs/autoware-map.md").read_text("utf-8").splitlines()
    if row.startswith("| `") or row.startswith("| callbacks") or row.startswith("| publishing")
]


def source(name: str) -> Path:
    """The file that a row means: of the controllers, unless it names a room."""
    return PACKAGE / (name if "/" in name else f"control/{name}")


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_every_file_and_function_is_there(row: list[str]) -> None:
    parts = [part for part in re.split(r"[;,] (?=`[a-z_/]+\.py`)", row[1].rstrip(" |")) if part]
    assert parts
    for part in parts:
        file, *functions = re.findall(r"`([^`]+)`", part)
        text = source(file).read_text("utf-8")
        for function in functions:
            name = function.rpartition(".")[2]
            assert re.search(rf"def {name}\(", text), f"{file} has no {name}"


def test_every_part_of_the_controllers_is_in_the_map() -> None:
    text = (ROOT / "docs/autoware-map.md").read_text("utf-8")
    for name in ("lateral.py", "mpc.py", "longitudinal.py", "smooth_stop.py", "cost.py"):
        assert f"`{name}`" in text
