# SPDX-License-Identifier: Apache-2.0
"""The first compilation says what it does; loading compiled code leaves nothing behind."""

from __future__ import annotations

import os
import select
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from subprocess import PIPE
from time import perf_counter

import pytest

from safety_island.cli import progress
from safety_island.cli.process import seconds_since_start
from safety_island.kernel import cache, kernel

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


@pytest.fixture
def held(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A kernel of which another process holds the lock."""
    monkeypatch.setattr(cache, "place", lambda: cache.Place(tmp_path, ""))
    (tmp_path / "step.lock").touch(0o600)
    command = ["flock", str(tmp_path / "step.lock"), "sh", "-c", "echo held; exec cat"]
    with subprocess.Popen(command, stdin=PIPE, stdout=PIPE, text=True) as holder:
        assert holder.stdout is not None and holder.stdin is not None
        assert holder.stdout.readline() == "held\n"
        yield str(holder.pid)
        holder.stdin.close()


def test_row_90_waiting_for_another_process_is_told_and_ends_at_a_limit(
    held: str, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    """It waited for ever, without a word."""
    monkeypatch.setattr(progress, "LOCK_POLL_S", 0.01)
    assert not progress._wait_for_others("step", perf_counter() + 1.0)
    lines = capsys.readouterr().err.splitlines()
    assert (
        lines[0].startswith("island: waiting at most ") and "which compiles kernel step" in lines[0]
    )
    still = f"island: process {held} still holds the lock of kernel step"
    assert lines[1:] == [f"{still}: compiling it for this run alone"]


def test_a_lock_that_is_free_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.setattr(cache, "place", lambda: cache.Place(tmp_path, ""))
    assert progress._wait_for_others("step", perf_counter())
    assert capsys.readouterr().err == ""


def test_row_90_a_kernel_whose_lock_stays_held_is_left_to_the_process_that_needs_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(progress, "_wait_for_others", lambda name, end: False)
    monkeypatch.setattr(progress, "_compile_one", lambda name: pytest.fail("compiled"))
    assert progress._compile_kept("step", 0.0) == "step"


def test_where_nothing_can_be_kept_is_told_and_kernels_are_compiled_in_this_process(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    """What other processes compile could not be loaded here."""
    monkeypatch.setattr(cache, "place", lambda: cache.Place(None, "no place"))
    monkeypatch.setattr(progress, "_missing", lambda on_demand: ["check_trajectory"])
    progress.prepare_kernels()
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "island: no place"
    assert lines[2] == "island:   1 of 1 done: check_trajectory"


def test_a_compiler_process_ends_with_the_start_that_began_it(tmp_path: Path) -> None:
    """Killed starts left processes behind, which held locks."""
    code = (
        "import os, subprocess, sys;"
        "worker = 'import os, time; from safety_island.platform.posix.process import end_with;'"
        "'end_with({}); print(os.getpid(), flush=True); time.sleep(600)'.format(os.getpid());"
        "subprocess.run([sys.executable, '-c', worker])"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=PIPE, text=True) as parent:
        assert parent.stdout is not None
        worker = os.pidfd_open(int(parent.stdout.readline()))
        parent.kill()
    assert select.select([worker], [], [], 60)[0], "it lives on"
    os.close(worker)


def test_age_of_this_process_grows() -> None:
    first = seconds_since_start()
    assert 0.0 < first <= seconds_since_start()
