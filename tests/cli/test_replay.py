# SPDX-License-Identifier: Apache-2.0
"""``island replay``: verdicts for people and scripts, CSV files, exit codes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from safety_island.cli.main import main
from safety_island.replay.recording import CONTRACT_COLUMNS
from tests.replay.runs import TICKS, changed, guarded, output_column, write

Capture = pytest.CaptureFixture[str]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Two runs that are right."""
    for name in ("bend/one.npz", "bend/two.npz"):
        write(tmp_path / "runs" / name)
    return tmp_path / "runs"


def tampered(path: Path, column: str = "velocity", tick: int = 5, value: float = 2.0) -> Path:
    """A run whose recording says something else."""
    return write(path, **changed("output", output_column(column), tick, value))


def strict_json(text: str) -> Any:
    """Parse JSON that has no NaN and no infinity."""

    def refuse(word: str) -> float:
        raise AssertionError(word)

    return json.loads(text, parse_constant=refuse)


def test_runs_that_are_right(folder: Path, capsys: Capture) -> None:
    assert main(["replay", str(folder)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"pass  bend/one  {TICKS} ticks"
    assert [word for word in lines[1].split() if word in CONTRACT_COLUMNS] == list(CONTRACT_COLUMNS)
    assert lines[1].endswith(f"guard: 0 of {TICKS} commands changed, 0 refused")
    assert lines[2] == f"pass  bend/two  {TICKS} ticks"
    assert lines[-1] == "2 runs: 2 passed, 0 failed"


def test_a_run_that_is_not_fails_by_name(folder: Path, capsys: Capture) -> None:
    tampered(folder / "bend" / "two.npz")
    assert main(["replay", str(folder)]) == 1
    out = capsys.readouterr().out
    assert "pass  bend/one" in out and "FAIL  bend/two" in out
    (line,) = [line for line in out.splitlines() if "first beyond tolerance" in line]
    assert "tick 5 (t = " in line and "velocity is " in line and "recorded 2" in line
    assert out.endswith("2 runs: 1 passed, 1 failed\n")


def test_what_the_guard_changes_fails_and_is_counted(tmp_path: Path, capsys: Capture) -> None:
    """What is published is compared, not what the controllers wanted."""
    path = write(tmp_path / "bend" / "one.npz", **guarded(velocity=0.5))
    assert main(["replay", str(path)]) == 1
    _, counts, exceeding, _ = capsys.readouterr().out.splitlines()
    assert f"of {TICKS} commands changed, 0 refused (VELOCITY " in counts
    assert "velocity is 0.5," in exceeding and exceeding.endswith("the guard clamped it (VELOCITY)")
    assert main(["replay", str(path), "--json"]) == 1
    (run,) = strict_json(capsys.readouterr().out)["runs"]
    changed = run["guard"]["changed"]
    assert 0 < changed == run["guard"]["limits"]["VELOCITY"]
    assert f"guard: {changed} of" in counts
    assert run["guard"]["first_tick"] == run["first_exceeding"]["tick"]
    assert counts.endswith(f"first in tick {run['guard']['first_tick']}")


def test_files_are_replayed_in_the_order_of_the_command(folder: Path, capsys: Capture) -> None:
    paths = [folder / "bend" / "two.npz", folder / "bend" / "one.npz"]
    assert main(["replay", *map(str, paths)]) == 0
    out = capsys.readouterr().out
    assert out.index("bend/two") < out.index("bend/one")


def test_json_for_a_script(folder: Path, capsys: Capture) -> None:
    tampered(folder / "bend" / "two.npz")
    assert main(["replay", str(folder), "--json"]) == 1
    told = strict_json(capsys.readouterr().out)
    assert set(told) == {"runs", "passed"} and told["passed"] is False
    good, bad = told["runs"]
    keys = ["name", "file", "ticks", "loose_ticks", "greatest_difference", "guard"]
    assert list(good) == [*keys, "first_exceeding", "passed"]
    nothing = {"changed": 0, "refused": 0, "limits": {}, "first_tick": None}
    assert good["guard"] == {"commands": TICKS, **nothing}
    assert (good["name"], good["ticks"], good["passed"]) == ("bend/one", TICKS, True)
    assert good["file"] == str(folder / "bend" / "one.npz")
    assert set(good["greatest_difference"]) == set(CONTRACT_COLUMNS)
    assert good["first_exceeding"] is None
    assert bad["passed"] is False
    exceeding = bad["first_exceeding"]
    assert list(exceeding) == ["tick", "t", "column", "recorded", "replayed", "tolerance"]
    assert (exceeding["tick"], exceeding["column"], exceeding["recorded"]) == (5, "velocity", 2.0)
    assert bad["greatest_difference"]["velocity"] == pytest.approx(abs(2.0 - exceeding["replayed"]))


@pytest.mark.parametrize(("column", "value"), [("velocity", np.nan), ("acceleration", np.inf)])
def test_json_knows_no_nan(tmp_path: Path, capsys: Capture, column: str, value: float) -> None:
    path = tampered(tmp_path / "a.npz", column, value=value)
    assert main(["replay", str(path), "--json"]) == 1
    (run,) = strict_json(capsys.readouterr().out)["runs"]
    assert run["greatest_difference"][column] is None
    assert run["first_exceeding"]["recorded"] is None


def test_every_run_gets_its_csv_also_one_that_fails(
    folder: Path, tmp_path: Path, capsys: Capture
) -> None:
    tampered(folder / "bend" / "two.npz")
    assert main(["replay", str(folder), "--csv", str(tmp_path / "out")]) == 1
    assert f"island: made the folder {tmp_path / 'out'}" in capsys.readouterr().err
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == ["bend__one.csv", "bend__two.csv"]
    first, second = ((tmp_path / "out" / name).read_text() for name in names)
    assert first == second, "what was replayed, not what was recorded"
    assert len(first.splitlines()) == TICKS + 1


def test_another_solver(folder: Path, capsys: Capture) -> None:
    """The exact solver agrees where no limit is near."""
    assert main(["replay", str(folder), "--solver", "daqp"]) == 0
    assert "2 passed" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "FILE_OR_FOLDER"),
        (["--solver", "magic", "x.npz"], "magic"),
        (["nowhere"], "nowhere does not exist"),
    ],
)
def test_what_cannot_be_replayed(words: list[str], told: str, capsys: Capture) -> None:
    assert main(["replay", *words]) == 2
    shown = capsys.readouterr()
    assert told in shown.err and shown.out == ""
    assert all(line.startswith("island: ") for line in shown.err.splitlines())


def test_a_file_that_is_no_run_ends_it(folder: Path, tmp_path: Path, capsys: Capture) -> None:
    (folder / "bend" / "zero.npz").write_bytes(b"nothing")
    assert main(["replay", str(folder)]) == 2
    error = capsys.readouterr().err
    assert f"{folder / 'bend' / 'zero.npz'} is no recorded run" in error
    assert len(error.splitlines()) == 1


def test_a_csv_folder_that_cannot_be_written(folder: Path, tmp_path: Path, capsys: Capture) -> None:
    (tmp_path / "file").write_text("")
    assert main(["replay", str(folder), "--csv", str(tmp_path / "file")]) == 1
    assert "cannot be written" in capsys.readouterr().err


def test_no_folder_is_made_around_that_of_the_csv(
    folder: Path, tmp_path: Path, capsys: Capture
) -> None:
    assert main(["replay", str(folder), "--csv", str(tmp_path / "wrong" / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "cannot be made: No such file or directory" in line
    assert not (tmp_path / "wrong").exists()
