# SPDX-License-Identifier: Apache-2.0
"""docs/json.md is what the tables say, and the tables are what the commands write."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from safety_island import __version__
from safety_island.bridge.bridge import Bridge
from safety_island.bridge.outlet import Counts
from safety_island.cli.exit_codes import EXIT_CODES
from safety_island.cli.json_keys import BRIDGE, COMMANDS, MAIN_COMPUTE, RUN, WHY, Key, Lines
from safety_island.cli.json_page import PAGE, main, render
from safety_island.cli.jsonlines import plain
from safety_island.cli.main import main as island
from safety_island.sim.courses import load_course
from safety_island.sim.world import World
from safety_island.status.why import why_values
from tests.status.samples import sample

ROOT = Path(__file__).parents[2]
KINDS: dict[str, tuple[type, ...]] = {
    "number": (float,),
    "integer": (int,),
    "text": (str,),
    "boolean": (bool,),
    "object": (dict,),
    "list of numbers": (list,),
    "list of texts": (list,),
}
ELEMENTS = {"list of numbers": float, "list of texts": str}


def agrees(value: object, key: Key) -> bool:
    """Whether a value has the type of its key."""
    if value is None:
        return key.may_be_null
    if type(value) not in KINDS[key.kind]:
        return False
    return not isinstance(value, list) or all(type(v) is ELEMENTS[key.kind] for v in value)


def check(lines: Lines, name: str, values: Mapping[str, Any]) -> None:
    """Compare an event with its table."""
    event = lines.events[name]
    assert set(event.keys) <= set(values) <= {*event.keys, *event.sometimes}
    for key, value in values.items():
        assert agrees(value, lines.keys[key]), f"{name}: {key} is {value!r}"


def test_the_committed_page_is_current() -> None:
    again = "run: python -m safety_island.cli.json_page"
    assert (ROOT / PAGE).read_text("utf-8") == render(), again


def test_it_is_written_where_it_is_asked_for(tmp_path: Path) -> None:
    main([str(tmp_path / "page.md")])
    assert (tmp_path / "page.md").read_text("utf-8") == render()


@pytest.mark.parametrize("lines", COMMANDS.values(), ids=COMMANDS)
def test_every_key_has_one_row_and_every_row_is_used(lines: Lines) -> None:
    used = {key for event in lines.events.values() for key in (*event.keys, *event.sometimes)}
    assert used <= set(lines.keys)
    assert lines is MAIN_COMPUTE or used == set(lines.keys)


@pytest.mark.parametrize("words", [(), ("-t", "freertos_posix")])
def test_what_a_run_writes(words: tuple[str, ...]) -> None:
    command = [sys.executable, "-m", "safety_island", "run", "--platform", "sim", "--json"]
    done = subprocess.run(
        [*command, "--duration", "3", *words], capture_output=True, text=True, check=True
    )
    events = [json.loads(line) for line in done.stdout.splitlines()]
    assert events[0].pop("version") == __version__
    assert {event["event"] for event in events} == set(RUN.events)
    for event in events:
        check(RUN, event.pop("event"), event)


def test_what_the_main_compute_writes() -> None:
    world = World(load_course("straight"), 100.0)
    for now in (100.0, 101.0):
        check(MAIN_COMPUTE, "status", plain(world.status(now)))  # type: ignore[arg-type]
        world.offer_command(now, 0.0, 1.0)
    world.advance(102.0)
    values: Any = plain({**world.summary(), "refused_commands": 0})
    check(MAIN_COMPUTE, "summary", values)


def test_what_the_bridge_writes() -> None:
    route = SimpleNamespace(source=(1, "a"), target=(2, "b"))
    link: Any = SimpleNamespace(route=route, is_open=True, counts=Counts())
    bridge = Bridge.__new__(Bridge)
    bridge.links = [link]
    written: list[tuple[str, Mapping[str, Any]]] = []
    bridge._report_end(lambda name, values: written.append((name, values)))
    assert [name for name, _ in written] == ["counts", "route"]
    for name, values in written:
        check(BRIDGE, name, values)


def test_what_status_why_writes() -> None:
    check(WHY, "why", why_values(sample(), [], None))


def test_the_help_and_the_page_have_one_table_of_exit_codes(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert island(["--help"]) == 0
    shown = capsys.readouterr().out
    for code, meaning in EXIT_CODES.items():
        assert f"{code:>3}  {meaning}" in shown
        assert f"| {code} | {meaning} |" in render()
