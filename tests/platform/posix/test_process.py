# SPDX-License-Identifier: Apache-2.0
"""SIGINT, SIGTERM and SIGHUP reach the callback and end a timer's wait."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading

import pytest

from safety_island.platform import load


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_the_wait_of_a_timer(number: signal.Signals) -> None:
    platform = load("posix")
    timer = platform.new_timer(3600.0)
    before = signal.getsignal(number)
    with platform.on_stop(timer.wake):
        threading.Timer(0.02, os.kill, (os.getpid(), number)).start()
        assert timer.wait() is None
    assert signal.getsignal(number) is before
    timer.close()


def test_what_nohup_ignores_stays_ignored() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with load("posix").on_stop(lambda: None):
            assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
            assert signal.getsignal(signal.SIGTERM) is not before
    finally:
        signal.signal(signal.SIGHUP, before)


def test_outside_the_main_thread_nothing_is_installed() -> None:
    before = signal.getsignal(signal.SIGTERM)
    inside: list[object] = []

    def elsewhere() -> None:
        with load("posix").on_stop(lambda: None):
            inside.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=elsewhere)
    thread.start()
    thread.join()
    assert inside == [before]


def test_leaving_flushes_what_was_printed_and_takes_nothing_apart() -> None:
    program = """
import atexit
from safety_island.platform.posix.process import leave
atexit.register(print, "taken apart")
print("said", end="")
leave(7)
"""
    run = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert (run.returncode, run.stdout, run.stderr) == (7, "said", "")
