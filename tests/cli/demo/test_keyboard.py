# SPDX-License-Identifier: Apache-2.0
"""Keys of a real terminal; its mode is restored however the process ends."""

from __future__ import annotations

import contextlib
import os
import pty
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Iterator

import pytest

from safety_island.cli.demo.keyboard import Keyboard
from tests.dds.waiting import wait_for

KEYS = termios.ICANON | termios.ECHO

PROGRAM = """
import select, signal, sys
from safety_island.cli.demo.keyboard import Keyboard
signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have it ignored
with Keyboard(0, lambda: print("suspended", flush=True), lambda: print("resumed", flush=True)) as k:
    print("ready", flush=True)
    while True:
        select.select([0], [], [], 0.05)
        for key in k.read() if select.select([0], [], [], 0)[0] else "":
            print("key", repr(key), flush=True)
            if key == "e":
                raise RuntimeError("fault")
"""

SHELL = """
import os, signal, subprocess, sys, termios
signal.signal(signal.SIGTTOU, signal.SIG_IGN)
child = subprocess.Popen([sys.executable, "-c", sys.argv[1]], process_group=0)
os.tcsetpgrp(0, child.pid)
print("pid", child.pid, flush=True)
while True:
    _, status = os.waitpid(child.pid, os.WUNTRACED)
    if not os.WIFSTOPPED(status):
        break
    os.tcsetpgrp(0, os.getpgrp())
    print("stopped", flush=True)
    sys.stdin.readline()
    os.tcsetpgrp(0, child.pid)
    os.kill(child.pid, signal.SIGCONT)
print("ended", flush=True)
sys.stdin.readline()
"""
"""What a shell with job control does: a process that is stopped gives the terminal back."""


class Terminal:
    """A pseudo-terminal with a program in it, below a shell."""

    def __init__(self) -> None:
        self.ours, theirs = pty.openpty()
        self.before = self.mode()
        self.shown = ""
        command = [sys.executable, "-c", SHELL, PROGRAM]
        self.shell = subprocess.Popen(
            ["setsid", "--ctty", *command], stdin=theirs, stdout=theirs, stderr=theirs
        )
        os.close(theirs)
        os.set_blocking(self.ours, False)
        self.sees("ready")
        self.pid = int(self.shown.split("pid ")[1].split()[0])

    def mode(self) -> int:
        """The local flags."""
        return int(termios.tcgetattr(self.ours)[3])

    def press(self, keys: str) -> None:
        """Type."""
        os.write(self.ours, keys.encode())

    def sees(self, text: str) -> None:
        """Wait until the screen shows something that it has not shown before."""

        def shows() -> bool:
            with contextlib.suppress(BlockingIOError):
                self.shown += os.read(self.ours, 4096).decode()
            return text in self.shown

        wait_for(shows)
        self.shown = self.shown.partition(text)[2] if text != "ready" else self.shown


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    found = Terminal()
    yield found
    found.shell.kill()
    found.shell.wait()
    os.close(found.ours)


def test_keys_come_at_once_and_are_not_echoed(terminal: Terminal) -> None:
    assert terminal.before & KEYS == KEYS
    assert terminal.mode() & KEYS == 0
    assert terminal.mode() & termios.ISIG, "Ctrl-C stays a signal"
    terminal.press("k")
    terminal.sees("key 'k'")
    terminal.press(" ")
    terminal.sees("key ' '")


def test_cursor_keys_are_no_keys(terminal: Terminal) -> None:
    terminal.press("\x1b[A")
    time.sleep(0.2)
    terminal.press("a")
    terminal.sees("key 'a'")
    assert "[" not in terminal.shown


@pytest.mark.parametrize(
    "number", [signal.SIGTERM, signal.SIGINT, signal.SIGQUIT], ids=lambda number: number.name
)
def test_mode_is_restored_after_a_signal(terminal: Terminal, number: signal.Signals) -> None:
    os.kill(terminal.pid, number)
    terminal.sees("ended")
    assert terminal.mode() == terminal.before


@pytest.mark.parametrize("key", ["\x03", "\x1c"], ids=["Ctrl-C", "Ctrl-backslash"])
def test_mode_is_restored_after_a_key_that_is_a_signal(terminal: Terminal, key: str) -> None:
    terminal.press(key)
    terminal.sees("ended")
    assert terminal.mode() == terminal.before


def test_mode_is_restored_after_an_exception(terminal: Terminal) -> None:
    terminal.press("e")
    terminal.sees("RuntimeError: fault")
    terminal.sees("ended")
    assert terminal.mode() == terminal.before


def test_terminal_is_given_back_while_the_program_is_suspended(terminal: Terminal) -> None:
    for _ in range(2):
        terminal.press("\x1a")
        terminal.sees("suspended")
        terminal.sees("stopped")
        assert terminal.mode() == terminal.before
        terminal.press("\n")
        terminal.sees("resumed")
        wait_for(lambda: terminal.mode() & KEYS == 0)
        terminal.press("x")
        terminal.sees("key 'x'")
    os.kill(terminal.pid, signal.SIGTERM)
    terminal.sees("ended")
    assert terminal.mode() == terminal.before


def test_a_terminal_that_has_gone_is_told() -> None:
    ours, theirs = pty.openpty()
    with Keyboard(theirs) as keyboard:
        os.close(ours)
        with pytest.raises(EOFError):
            keyboard.read()
    os.close(theirs)
