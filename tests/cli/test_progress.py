"""The first compilation says what it does; loading compiled code leaves nothing behind."""

from __future__ import annotations

import pytest

from safety_island.cli import progress
from safety_island.cli.process import seconds_since_start
from safety_island.control import kernel

Capture = pytest.CaptureFixture[str]


def test_compilation_is_told(monkeypatch: pytest.MonkeyPatch, capsys: Capture) -> None:
    def compile_both(names: list[str], show: progress.Report) -> None:
        for index, name in enumerate(names):
            show(name, index, len(names))

    monkeypatch.setattr(progress, "_missing", lambda on_demand: ["first", "second"])
    monkeypatch.setattr(progress, "_compile", compile_both)
    monkeypatch.setattr(kernel, "prepare", lambda: None)
    progress.prepare_kernels()
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].startswith("island: compiling the control kernels, once")
    assert lines[1:3] == ["island:   1 of 2 done: first", "island:   2 of 2 done: second"]
    assert lines[3].startswith("island: control kernels compiled in ")


def test_loading_is_silent(capsys: Capture) -> None:
    progress.prepare_kernels()
    capsys.readouterr()
    progress.prepare_kernels()
    assert capsys.readouterr().err == ""


def test_kernels_without_compiled_code_are_compiled_in_processes_of_their_own(
    capsys: Capture,
) -> None:
    """A kernel that is on disk is only loaded there, which is quick."""
    progress.prepare_kernels()
    done: list[str] = []
    progress._compile(["check_trajectory"], lambda name, index, count: done.append(name))
    assert done == ["check_trajectory"]


def test_age_of_this_process_grows() -> None:
    first = seconds_since_start()
    assert 0.0 < first <= seconds_since_start()
