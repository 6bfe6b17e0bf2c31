# SPDX-License-Identifier: Apache-2.0
"""``island params`` shows every value with its origin and tells every mistake of a file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safety_island.cli.main import main
from safety_island.params import SETS, describe, read

Capture = pytest.CaptureFixture[str]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A parameter file that changes one value."""
    path = tmp_path / "mine.yaml"
    path.write_text("/**:\n  ros__parameters:\n    input_delay: 0.3\n")
    return path


@pytest.mark.parametrize("name", SETS)
def test_show_has_a_line_for_every_parameter(name: str, capsys: Capture) -> None:
    assert main(["params", "show", "--params", name]) == 0
    shown = capsys.readouterr().out.splitlines()
    for row in describe(read((), name)):
        (line,) = [line for line in shown if line.startswith(f"  {row.key} ")]
        assert f"  {row.value}" in line
        assert line.endswith(row.origin)


def test_show_explains_on_request(capsys: Capture) -> None:
    assert main(["params", "show", "--doc"]) == 0
    text = capsys.readouterr().out
    assert all(f"\n      {row.doc}\n" in text for row in describe(read(())))


def test_show_as_json(capsys: Capture) -> None:
    assert main(["params", "show", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["key"] for row in rows] == [row.key for row in describe(read(()))]


def test_difference_of_two_sets(file: Path, capsys: Capture) -> None:
    words = ["params", "show", "--params", "default", str(file), "--against", "default"]
    assert main(words) == 0
    (line,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("  ")]
    assert line.split()[:2] == ["input_delay", "0.3"]
    assert "(not " in line
    assert line.endswith(f"{file}:3")


def test_check_accepts_a_good_file(file: Path, capsys: Capture) -> None:
    assert main(["params", "check", str(file)]) == 0
    assert capsys.readouterr().out.endswith(f"{file}: no mistake found\n")


def test_check_notes_what_the_firmware_set_does_not_do(capsys: Capture) -> None:
    assert main(["params", "check", "firmware"]) == 0
    assert "note: steering_lpf_cutoff_hz 10 Hz is not below" in capsys.readouterr().out


def test_check_tells_every_mistake_with_its_line(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text("/**:\n  ros__parameters:\n    inptu_delay: 0.3\n    kp: fast\n")
    assert main(["params", "check", str(path)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    first, second = captured.err.splitlines()
    assert first.startswith(f"island: error: {path}:3: inptu_delay: is not a known key")
    assert second.startswith(f"island: error: {path}:4: kp: found the text 'fast'")


def test_two_sets_at_once_are_refused(capsys: Capture) -> None:
    assert main(["params", "check", "firmware", "default"]) == 2
    assert "two parameter sets, 'firmware' and 'default'" in capsys.readouterr().err


def test_unknown_option_of_an_action_suggests_the_nearest(capsys: Capture) -> None:
    assert main(["params", "show", "--jsn"]) == 2
    assert "did you mean '--json'?" in capsys.readouterr().err
