# SPDX-License-Identifier: Apache-2.0
"""SIGINT, SIGTERM and SIGHUP end a command that starts up, whatever it is doing."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

from safety_island.cli.stopping import StopAtOnce

DEAF = """
import hashlib
from safety_island.cli.stopping import StopAtOnce
with StopAtOnce():
    print("ready", flush=True)
    hashlib.pbkdf2_hmac("sha256", b"x", b"y", 2**31 - 1)  # minutes of C that hear no signal
"""

DISARMED = """
import signal, threading
from safety_island.cli.stopping import StopAtOnce
told = threading.Event()
with StopAtOnce() as start:
    signal.signal(signal.SIGTERM, lambda *_: told.set())
    start.disarm()
    print("ready", flush=True)
    while not told.wait(0.01): pass
    print("in order")
"""


def stop(code: str, number: signal.Signals) -> tuple[int, str]:
    command = [sys.executable, "-c", code]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        process.send_signal(number)
        rest, _ = process.communicate(timeout=60)
        return process.returncode, rest


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_deaf_start_ends_with_zero(number: signal.Signals) -> None:
    assert stop(DEAF, number) == (0, "")


def test_handlers_take_over_after_the_start() -> None:
    assert stop(DISARMED, signal.SIGTERM) == (0, "in order\n")


def test_handlers_are_put_back() -> None:
    before = signal.getsignal(signal.SIGTERM)
    with StopAtOnce() as start:
        assert signal.getsignal(signal.SIGTERM) is not before
        start.disarm()
        start.disarm()
    assert signal.getsignal(signal.SIGTERM) is before


BLOCKED = """
import signal
from safety_island.cli import main
numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
main.main = lambda: print(sorted(signal.pthread_sigmask(signal.SIG_BLOCK, ()))) or 0
from safety_island.__main__ import start
start()
"""


def test_signals_that_a_parent_left_blocked_are_heard() -> None:
    """It could not be ended."""
    done = subprocess.run([sys.executable, "-c", BLOCKED], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("[]\n", "")
