# SPDX-License-Identifier: Apache-2.0
"""Standard streams that are closed or full, and an interrupt before the command is there."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys

import pytest

from safety_island import __main__ as module
from safety_island import __version__
from safety_island.cli import main as frame
from safety_island.cli import streams

COMMAND = f"{sys.executable} -m safety_island"


def shell(line: str) -> subprocess.CompletedProcess[str]:
    """Run a line of shell, where streams are closed and redirected as a user does it."""
    return subprocess.run(["sh", "-c", line], capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize("closed", ["<&-", ">&-", "<&- >&-"])
def test_a_closed_stream_is_as_good_as_the_null_device(closed: str) -> None:
    done = shell(f"{COMMAND} --version {closed}")
    shown = "" if ">" in closed else f"island {__version__}\n"
    assert (done.returncode, done.stdout, done.stderr) == (0, shown, "")


def test_an_error_with_nowhere_to_go_keeps_its_exit_code() -> None:
    done = shell(f"{COMMAND} nope 2>&-")
    assert (done.returncode, done.stdout) == (2, "")


def test_an_error_that_nobody_reads_keeps_its_exit_code() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run([*COMMAND.split(), "nope"], stderr=writing, timeout=60)
    os.close(writing)
    assert done.returncode == 2


def test_a_line_that_nobody_reads_ends_nothing() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    code = "from safety_island.cli.tell import tell, tell_lost; tell('a'); tell_lost('b'); print(1)"
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=writing, timeout=60)
    os.close(writing)
    assert (done.returncode, done.stdout) == (0, b"1\n")


def test_a_full_disk_is_told_in_one_line() -> None:
    done = shell(f"{COMMAND} --help > /dev/full")
    assert done.returncode == 1
    text = "cannot write: No space left on device; make room and try again"
    assert done.stderr == f"island: error: {text}\n"


def test_a_descriptor_that_was_closed_is_not_given_to_a_socket() -> None:
    code = (
        "import os, sys; from safety_island.cli.streams import open_missing; open_missing();"
        "sys.exit(os.fstat(2).st_rdev != os.stat(os.devnull).st_rdev or sys.stderr is None)"
    )
    done = shell(f"{sys.executable} -c '{code}' 2>&-")
    assert done.returncode == 0


def test_streams_that_are_open_stay_as_they_are() -> None:
    before = (sys.stdin, sys.stdout, sys.stderr, os.fstat(1), os.fstat(2))
    streams.open_missing()
    assert (sys.stdin, sys.stdout, sys.stderr, os.fstat(1), os.fstat(2)) == before


@pytest.mark.parametrize(
    ("number", "full"), [(errno.ENOSPC, True), (errno.EDQUOT, True), (errno.EIO, False)]
)
def test_what_counts_as_full(number: int, full: bool) -> None:
    assert streams.is_full(OSError(number, "")) is full


def test_the_usual_handler_of_interrupts_is_back_when_the_command_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen: list[object] = []

    def look() -> int:
        seen.append(signal.getsignal(signal.SIGINT))
        return 0

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    monkeypatch.setattr(frame, "main", look)
    try:
        assert module.start() == 0
    finally:
        signal.signal(signal.SIGINT, before)
    assert seen == [signal.default_int_handler]


def test_an_ignored_interrupt_stays_ignored(monkeypatch: pytest.MonkeyPatch) -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    monkeypatch.setattr(frame, "main", lambda: 0)
    try:
        module.start()
        assert signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
