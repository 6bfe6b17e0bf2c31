# SPDX-License-Identifier: Apache-2.0
"""The page docs/status.md is what the code says."""

from __future__ import annotations

from enum import Enum, IntFlag
from pathlib import Path

import pytest

from safety_island.cli import status_page
from safety_island.cli.status.docs import member_docs, message_fields
from safety_island.cli.status_page import PAGE, main, render
from safety_island.control.status import ControllerLimit
from safety_island.input_gate import reason as sample_reason
from safety_island.input_gate import warning
from safety_island.life_cycle import reason
from safety_island.life_cycle.state import State
from safety_island.messages import registry
from safety_island.messages.arm import ARM, ArmResult
from safety_island.messages.status import INPUT_STATUS, STATUS

ROOT = Path(__file__).parents[2]


class Limit(IntFlag):
    """Stands in for the guard's."""

    ANGLE = 1


def test_the_committed_page_is_current() -> None:
    again = "run: python -m safety_island.cli.status_page"
    assert (ROOT / PAGE).read_text("utf-8") == render(), again


@pytest.mark.parametrize("enum", [State, ControllerLimit, ArmResult])
def test_every_member_tells_what_it_means(enum: type[Enum]) -> None:
    docs = member_docs(enum)
    assert list(docs) == [item.name for item in enum]
    assert all(docs.values())


@pytest.mark.parametrize("module", [reason, sample_reason, warning])
def test_every_reason_is_explained(module: object) -> None:
    table = module.EXPLANATIONS  # type: ignore[attr-defined]
    (enum,) = {type(item) for item in table}
    assert list(table) == list(enum.__members__.values())
    assert all(meaning and action for meaning, action in table.values())


@pytest.mark.parametrize("name", [STATUS, INPUT_STATUS, ARM])
def test_every_field_stands_on_it_with_its_meaning(name: str) -> None:
    fields = list(message_fields(name))
    assert [field.name for field in fields] == [f.name for f in registry.struct_of(name).fields]
    assert all(field.meaning.endswith(".") for field in fields)
    assert {field.unit for field in fields} <= {
        "",
        "ns",
        "s",
        "m",
        "m/s",
        "m/s^2",
        "rad",
        "rad/s",
        "byte",
    }
    assert all(f"| `{field.name}` | `{field.type}` |" in render() for field in fields)


def test_the_limits_of_the_guard_stand_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(status_page, "GUARD_LIMITS", {Limit.ANGLE: ("too far", "turn back")})
    assert "## Limits of the guard" in render()
    assert "| 1 | `ANGLE` | too far | turn back |" in render()


def test_it_is_written_where_it_is_asked_for(tmp_path: Path) -> None:
    main([str(tmp_path / "page.md")])
    assert (tmp_path / "page.md").read_text("utf-8") == render()
