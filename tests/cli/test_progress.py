"""The first compilation says what it does; loading compiled code leaves nothing behind."""

from __future__ import annotations

import pytest

from safety_island.cli import progress
from safety_island.cli.process import seconds_since_start
from safety_island.control import kernel

Capture = pytest.CaptureFixture[str]


@pytest.fixture
def entries(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two kernels whose preparation does nothing."""

    def prepare(report: progress.Report) -> None:
        report("first", 0, 2)
        report("second", 1, 2)

    monkeypatch.setattr(kernel, "prepare", prepare)


@pytest.mark.usefixtures("entries")
def test_compilation_is_told(monkeypatch: pytest.MonkeyPatch, capsys: Capture) -> None:
    monkeypatch.setattr(kernel, "is_cached", lambda: False)
    progress.prepare_kernels()
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].startswith("island: compiling the control kernels, once")
    assert lines[1:3] == ["island:   1 of 2: first", "island:   2 of 2: second"]
    assert lines[3].startswith("island: control kernels compiled in ")


@pytest.mark.usefixtures("entries")
def test_loading_is_silent(monkeypatch: pytest.MonkeyPatch, capsys: Capture) -> None:
    monkeypatch.setattr(kernel, "is_cached", lambda: True)
    progress.prepare_kernels()
    assert capsys.readouterr().err == ""


def test_age_of_this_process_grows() -> None:
    first = seconds_since_start()
    assert 0.0 < first <= seconds_since_start()
