# SPDX-License-Identifier: Apache-2.0
"""A page is opened where there is a desktop, and nowhere else."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from safety_island.cli.browser import OPENER, open_page

LIMIT_S = 20.0


@pytest.fixture
def opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stand in for the desktop's opener; return the file that it notes the address in."""
    note = tmp_path / "opened"
    program = tmp_path / OPENER
    program.write_text(f'#!/bin/sh\necho "$1" > {note}.part\nmv {note}.part {note}\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    return note


@pytest.mark.parametrize("name", ["DISPLAY", "WAYLAND_DISPLAY"])
@pytest.mark.filterwarnings("ignore:subprocess .* is still running:ResourceWarning")
def test_on_a_desktop(name: str, opened: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(name, ":0")
    assert open_page("http://127.0.0.1:8140/#t")
    end = time.monotonic() + LIMIT_S
    while not opened.exists():
        assert time.monotonic() < end
        time.sleep(0.01)
    assert opened.read_text() == "http://127.0.0.1:8140/#t\n"


def test_without_a_desktop_nothing_is_started(
    opened: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert not open_page("http://127.0.0.1:8140/")
    assert not opened.exists()


def test_without_an_opener(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert not open_page("http://127.0.0.1:8140/")
