# SPDX-License-Identifier: Apache-2.0
"""``island bench tick``: what it prints and what it takes; how long a tick is, no test says."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from safety_island.bench import ratios
from safety_island.cli.main import main

pytest.importorskip("osqp")
Capture = pytest.CaptureFixture[str]
ROOT = Path(__file__).parents[2]


def test_json_has_the_keys_that_scripts_read(capsys: Capture) -> None:
    assert main(["bench", "tick", "--rounds", "1", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    times = {"median_us", "p99_us", "max_us", "yardstick_us", "ratio"}
    assert times <= set(told)
    assert all(math.isfinite(told[name]) and told[name] > 0.0 for name in times)
    assert told["median_us"] <= told["p99_us"] <= told["max_us"]
    assert told["ratio"] == pytest.approx(told["median_us"] / told["yardstick_us"])
    assert (told["solver"], told["ticks"]) == ("unconstraint_fast", 300)


def test_one_solver_for_a_person(capsys: Capture) -> None:
    assert main(["bench", "tick", "--rounds", "1", "--solver", "daqp"]) == 0
    head, row, foot, whole, firmware = capsys.readouterr().out.splitlines()
    assert head.split() == ["solver", "median", "p99", "max", "yardstick", "ratio", "whole", "node"]
    assert row.split()[0] == "daqp" and row.count(" us") == 4
    assert foot.endswith(ratios.YARDSTICK) and "gate" in whole
    assert "C++" in firmware and firmware.endswith(ratios.METHOD)


def test_one_yardstick_with_one_definition(capsys: Capture) -> None:
    """Help and README define it in the words of the output; no other figure is in yardsticks."""
    with pytest.raises(SystemExit):
        main(["bench", "--help"])
    help_text = " ".join(capsys.readouterr().out.split())
    readme = " ".join((ROOT / "README.md").read_text("utf-8").split())
    for text in (help_text, readme):
        assert ratios.YARDSTICK in text and ratios.METHOD in text


def test_the_readme_states_the_ratios_that_the_code_states() -> None:
    readme = (ROOT / "README.md").read_text("utf-8")
    speed = readme[readme.index("## Speed") : readme.index("## When something fails")]
    single = (ratios.HEAP_TUNED, ratios.AS_SHIPPED, ratios.INSTRUCTIONS, ratios.WHOLE_NODE)
    for ratio in (*single, *ratios.POINTS.values(), *ratios.HORIZON.values()):
        assert f"{ratio:g}x" in speed
    for size in (*ratios.POINTS, *ratios.HORIZON):
        assert f"{size:,}" in speed


def test_the_ratios_fit_each_other() -> None:
    """Tick and whole node of the README, in yardsticks, make the ratio of the whole node."""
    tick, node = yardsticks("island, `unconstraint_fast`"), yardsticks("the same within")
    assert ratios.HEAP_TUNED * tick / node == pytest.approx(ratios.WHOLE_NODE, rel=0.05)
    assert ratios.HEAP_TUNED < ratios.INSTRUCTIONS < ratios.AS_SHIPPED


def yardsticks(row: str) -> float:
    """The first figure of a row of the README's table of yardsticks."""
    lines = (ROOT / "README.md").read_text("utf-8").splitlines()
    (found,) = [line for line in lines if line.startswith("| island") and row in line]
    return float(found.split("|")[2])


def test_virtual_time(capsys: Capture) -> None:
    assert main(["bench", "virtual", "--rounds", "1", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["real_time_factor"] == pytest.approx(told["period_s"] * 1e6 / told["tick_us"])
    assert (told["ticks"], told["period_s"]) == (300, 0.15)
    assert 0.0 < told["tick_us"] <= told["p99_us"] <= told["max_us"]
    assert main(["bench", "virtual", "--rounds", "1"]) == 0
    assert "times real time at 150 ms" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["bench"], "tick"),
        (["bench", "tick", "--rounds", "0"], "'0' is not a number of rounds (1 to 1000)"),
        (["bench", "tick", "--rounds", "1001"], "'1001'"),
        (["bench", "tick", "--rounds", "two"], "'two'"),
        (["bench", "tick", "--rounds", "\u0661"], "is not a number of rounds"),
        (["bench", "tick", "--solver", "osqp"], "osqp"),
        (["bench", "virtual", "--solver", "osqp"], "osqp"),
    ],
)
def test_what_it_does_not_take(words: list[str], told: str, capsys: Capture) -> None:
    assert main(words) == 2
    shown = capsys.readouterr()
    assert told in shown.err and shown.out == ""
