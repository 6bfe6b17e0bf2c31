# SPDX-License-Identifier: Apache-2.0
"""Rows 67 to 70 of the fault catalogue: what is configured wrong does not start.

Every key of every shipped file in every way: tests/params/test_mutations.py; every field of the
DBC file: tests/can/test_dbc.py. Here the command itself is asked, once for each kind of fault.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from safety_island.can.dbc import dbc_text
from safety_island.can.dbc_check import check_dbc
from safety_island.cli.main import main
from safety_island.params.schema import KNOWN, Known
from tests.params.files import copy_of_set, may_be_missing, parameter_file, refused

Output = pytest.CaptureFixture[str]


def does_not_start(capsys: Output, *files: Path) -> list[str]:
    """Ask for a start with these files: exit code 2, nothing started; return what is told."""
    options = [word for file in files for word in ("--params", str(file))]
    assert main(["run", "--platform", "sim", "--duration", "1", *options]) == 2
    found = capsys.readouterr()
    assert "is live" not in found.out + found.err
    return found.err.splitlines()


def test_row_67_a_misspelt_key(tmp_path: Path, capsys: Output) -> None:
    path = parameter_file(tmp_path, "ctrl_period: 0.15\nctrl_perod: 0.15")
    (told,) = does_not_start(capsys, path)
    assert told.startswith(f"island: error: {path}:4: ctrl_perod: is not a known key")
    assert "ctrl_period" in told


def test_row_67_a_key_that_is_given_twice(tmp_path: Path, capsys: Output) -> None:
    path = parameter_file(tmp_path, "ctrl_period: 0.15\nctrl_period: 0.03")
    (told,) = does_not_start(capsys, path)
    assert told.startswith(f"island: error: {path}:4: ctrl_period: found a second time")


def test_row_67_each_missing_key(tmp_path: Path) -> None:
    """A complete set of files without one of its lines, for each line that gives a value."""
    files = copy_of_set("default", tmp_path)
    count = 0
    for path in files.values():
        text = path.read_text()
        lines = text.splitlines()
        for number in value_lines(lines):
            path.write_text("\n".join(lines[:number] + lines[number + 1 :]) + "\n")
            count += 1
            if may_be_missing(key_of_line(lines, number), "default"):
                continue
            told = refused(list(files.values()), None)
            assert any(": is missing; expected " in line and str(path) in line for line in told)
        path.write_text(text)
    assert count == len(KNOWN)


def key_of_line(lines: list[str], number: int) -> str:
    """Return the key of a line with the name of the map that it stands in."""
    match = re.match(r"( +)(\w+):", lines[number])
    assert match
    above = [line for line in lines[:number] if re.match(r" {4}\w+: *(#.*)?$", line)]
    prefix = f"{above[-1].strip().partition(':')[0]}." if len(match[1]) > 4 else ""
    return prefix + match[2]


def value_lines(lines: list[str]) -> Iterator[int]:
    """Yield the index of each line that gives a value."""
    for number, line in enumerate(lines):
        if re.match(r" {4,}\w+: *[^\s#]", line):
            yield number


def wrong_values(known: Known) -> list[str]:
    """One value of another type, one that is no number, one beyond each end of the range."""
    if known.kind == "bool":
        return ["1", "'true'"]
    if known.kind == "str":
        return ["1", "[a]"]
    values = [".nan", ".inf", f"{known.high + max(1.0, abs(known.high))}", "true"]
    if known.kind == "int":
        values[2] = str(int(known.high) + 1)
    if known.kind == "list":
        return [f"[{value}]" for value in values] + ["0.1"]
    return [*values, str(int(known.low) - 1 if known.kind == "int" else known.low - 1.0)]


def test_row_68_each_key_with_wrong_values(tmp_path: Path) -> None:
    """NaN, infinity, another type, out of range: for each of the keys, each named at its line."""
    path = tmp_path / "my.param.yaml"
    for number in range(5):
        keys = [key for key in KNOWN if number < len(wrong_values(KNOWN[key]))]
        body = "\n".join(f"    {key}: {wrong_values(KNOWN[key])[number]}" for key in keys)
        path.write_text("/**:\n  ros__parameters:\n" + body + "\n")
        told = refused([path])
        for line, key in enumerate(keys, 3):
            assert any(t.startswith(f"{path}:{line}: {key}") for t in told), (key, number)


@pytest.mark.parametrize("value", ["-0.15", "0", ".nan", ".inf", "fast", "[0.15]", "1e9", ""])
def test_row_68_the_command_refuses(tmp_path: Path, capsys: Output, value: str) -> None:
    path = parameter_file(tmp_path, f"ctrl_period: {value}")
    told = does_not_start(capsys, path)
    assert told[0].startswith(f"island: error: {path}:3: ctrl_period: ")
    assert "expected" in told[0]


INCONSISTENT = {
    "period above timeout": "timeout_thr_sec: 0.1",
    "filter above Nyquist": "steering_lpf_cutoff_hz: 10.0",
    "lengths of lists": "curvature_list_for_steer_rate_lim: [0.001, 0.01]",
    "order of a list": "velocity_list_for_steer_rate_lim: [10, 10, 20]",
    "horizon below one": "mpc_prediction_horizon: 0",
    "limits crossed": "smooth_stop_min_strong_acc: -0.4",
    "delay beyond memory": "input_delay: 1.95\nctrl_period: 0.03\ntimeout_thr_sec: 0.5",
}


@pytest.mark.parametrize("name", INCONSISTENT)
def test_row_69_what_does_not_fit_together(tmp_path: Path, capsys: Output, name: str) -> None:
    """All rules: tests/params/test_consistency.py."""
    path = parameter_file(tmp_path, INCONSISTENT[name])
    told = does_not_start(capsys, path)
    assert told[0].startswith(f"island: error: {path}:3: "), told
    assert "expected" in told[0]


MUTATIONS = {
    "overlap": ("rotation_rate : 32|32", "rotation_rate : 16|32"),
    "missing signal": (" SG_ sequence :", " SG_ sequence M :"),
    "scale": ("(1e-06,0)", "(1e-05,0)"),
    "identifier": ("BO_ 256 ", "BO_ 512 "),
    "length": ("LATERAL_COMMAND: 8", "LATERAL_COMMAND: 9"),
    "no DBC": ("BO_ 257", "BOX_ 257"),
}


@pytest.mark.parametrize("name", MUTATIONS)
def test_row_70_a_changed_dbc_is_refused(name: str, tmp_path: Path) -> None:
    text, (old, new) = dbc_text(), MUTATIONS[name]
    if old not in text:
        old, new = re.search(r"\(([\d.e-]+),0\)", text)[0], "(0.5,0)"  # type: ignore[index]
    assert check_dbc(text) == []
    assert check_dbc(text.replace(old, new, 1))
