# SPDX-License-Identifier: Apache-2.0
"""The demo as a person starts it: its processes on loopback."""

from __future__ import annotations

import csv
import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import termios
import time
from contextlib import closing
from pathlib import Path
from xml.etree import ElementTree

import pytest

pytestmark = [pytest.mark.live, pytest.mark.timeout(300)]


DEMO = (sys.executable, "-m", "safety_island", "demo")


def test_drives_and_stops() -> None:
    command = [*DEMO, "--duration", "16", "--json"]
    process = subprocess.run(command, capture_output=True, text=True, timeout=280)
    summary = json.loads(process.stdout)
    # Ticks are missed when tests keep every core busy; all else is the drive's own doing.
    driven = {name: ok for name, ok in summary["conditions"].items() if name != "no_missed_ticks"}
    assert all(driven.values()), process.stderr
    assert process.returncode == (0 if summary["ok"] else 1)
    assert summary["vehicle"]["finished"]
    assert summary["island"]["published"] > 0
    assert summary["forwarded"] > 0
    assert summary["first_control_s"] > 0.0


@pytest.mark.parametrize("victim", ["run", "bridge", "main-compute"])
def test_death_of_a_process_is_told_and_ends_all(victim: str) -> None:
    command = [*DEMO, "--plain"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if "m/s" in line:
                break
        children = children_of(process.pid)
        assert set(children) == {"run", "bridge", "main-compute", "monitor"}
        os.kill(children[victim], signal.SIGKILL)
        _, error = process.communicate(timeout=60)
    name = {"run": "island"}.get(victim, victim)
    assert process.returncode == 1
    assert f"island: error: {name} died (signal SIGKILL)" in error
    assert not any(Path(f"/proc/{pid}").exists() for pid in children.values())


def test_death_of_the_page_is_told_and_touches_nothing() -> None:
    command = [*DEMO, "--plain", "--duration", "12"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if "the page: http" in line:
                break
        os.kill(children_of(process.pid)["monitor"], signal.SIGKILL)
        output, error = process.communicate(timeout=120)
    assert "the page has ended (signal SIGKILL); the drive goes on without it" in output
    assert "  ok  stopped once" in output, output + error


def test_without_a_page() -> None:
    command = [*DEMO, "--plain", "--no-page"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        process.stdout.readline()
        assert set(children_of(process.pid)) <= {"run", "bridge", "main-compute"}
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)


def test_killed_demo_leaves_nobody_behind() -> None:
    command = [*DEMO, "--plain"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        process.stdout.readline()
        children = children_of(process.pid)
        watched = [os.pidfd_open(pid) for pid in children.values()]
        process.kill()
    for descriptor in watched:
        assert ended(descriptor), "a child outlives the demo"


def test_domains_in_use_are_told(domain_pair: tuple[int, int]) -> None:
    first, second = map(str, domain_pair)
    command = [*DEMO, "--domains", first, second]
    process = subprocess.run(command, capture_output=True, text=True, timeout=280)
    assert process.returncode == 1
    assert f"DDS domain {first} or {second} is in use on this machine" in process.stderr


def test_kernels_are_compiled_before_anything_starts(tmp_path: Path) -> None:
    environment = os.environ | {"SAFETY_ISLAND_CACHE": str(tmp_path)}
    with subprocess.Popen(
        DEMO, stderr=subprocess.PIPE, text=True, env=environment, start_new_session=True
    ) as process:
        assert process.stderr is not None
        assert process.stderr.readline().startswith("island: compiling the control kernels")
        os.killpg(process.pid, signal.SIGKILL)


def test_ends_without_a_warning_of_its_own_making() -> None:
    """What the processes log at the end is shown by the summary's run, too."""
    code = (
        "import sys; from safety_island.cli import demo; from safety_island.cli.main import main;"
        "real = demo.conditions;"
        "show = lambda state, *rest: print(*state.messages, sep='\\n') or real(state, *rest);"
        "demo.conditions = show; sys.exit(main(['demo', '--plain', '--duration', '8']))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        timeout=280,
        stdin=subprocess.DEVNULL,
    )
    logged = done.stdout.splitlines()
    ended = max(i for i, line in enumerate(logged) if "main-compute: stopped" in line)
    assert any("island: safety_island ends after" in line for line in logged), done.stdout
    assert any("bridge: forwarded" in line for line in logged), done.stdout
    for word in ("WARN", "ERROR", "SILENT", "braking", "gone"):
        assert not any(word in line for line in logged[ended:]), done.stdout


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_end_during_the_start_judges_nothing(number: signal.Signals) -> None:
    command = [*DEMO, "--plain"]
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert "waiting for" in process.stdout.readline()
        children = children_of(process.pid)
        process.send_signal(number)
        output, error = process.communicate(timeout=60)
    assert process.returncode == 128 + signal.SIGINT
    assert "nothing to judge" in output
    for word in ("FAILED", "  ok  ", "error", "Traceback"):
        assert word not in output + error
    assert not any(Path(f"/proc/{pid}").exists() for pid in children.values())


class Screen:
    """The demo in a pseudo-terminal of its own; what it has shown, without control sequences."""

    CONTROLS = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")

    def __init__(self, *arguments: str) -> None:
        self.ours, theirs = pty.openpty()
        termios.tcsetwinsize(theirs, (40, 160))
        self.before = termios.tcgetattr(theirs)
        self._shown = ""
        self.process = subprocess.Popen(
            ["setsid", "--ctty", *DEMO, *arguments],
            stdin=theirs,
            stdout=theirs,
            stderr=theirs,
            env=os.environ | {"TERM": "xterm-256color"},
        )
        os.close(theirs)

    def close(self) -> None:
        """End the demo, however far it has come."""
        self.process.kill()
        self.process.wait()
        os.close(self.ours)

    def press(self, key: str) -> None:
        """Press a key."""
        os.write(self.ours, key.encode())

    def sees(self, pattern: str, limit_s: float = 90.0) -> re.Match[str]:
        """Wait until something is shown; what was shown up to then is forgotten."""
        end = time.monotonic() + limit_s
        while time.monotonic() < end:
            if found := re.search(pattern, self._shown):
                self._shown = self._shown[found.end() :]
                return found
            if select.select([self.ours], [], [], 1.0)[0]:
                data = os.read(self.ours, 65536).decode(errors="ignore")
                self._shown = (self._shown + self.CONTROLS.sub("", data))[-100_000:]
        raise AssertionError(f"never shown: {pattern}\n{self._shown[-8000:]}")


def test_keys_disturb_the_drive_and_the_reactions_are_shown(tmp_path: Path) -> None:
    log, picture = tmp_path / "drive.csv", tmp_path / "drive.svg"
    with closing(Screen("--log", str(log), "--plot", str(picture))) as screen:
        screen.sees(r"[1-9]\d* of \d+ m\b")  # it has driven a metre
        assert termios.tcgetattr(screen.ours)[3] & termios.ECHO == 0
        screen.press("k")
        screen.sees("key k: bridge killed")
        found = screen.sees(r"island SILENT after (\d\.\d+) s, bound 0\.73 s")
        assert float(found[1]) > 0.0
        screen.sees("vehicle braking after")
        screen.press("k")
        screen.sees("key k: bridge started anew")
        for _ in range(20):  # until the inputs have come through the new bridge
            screen.press("a")
            screen.sees("key a: the island is asked to arm")
            if screen.sees(r"arm: (armed|not needed|refused)")[1] != "refused":
                break
        screen.sees("vehicle driving after")
        screen.press("q")
        screen.sees(r"ok  \d+ ticks|FAILED|BUSY")
        screen.process.wait(60)
        assert termios.tcgetattr(screen.ours) == screen.before
    rows = list(csv.DictReader(log.read_text().splitlines()))
    events = " ".join(row["event"] for row in rows)
    assert "key k: bridge killed" in events
    assert "island SILENT" in events
    assert {"ACTIVE", "SILENT"} <= {row["island"] for row in rows}
    ElementTree.fromstring(picture.read_text())


def children_of(pid: int) -> dict[str, int]:
    """Process ids of the children of a process, by their command."""
    listed = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    found = {}
    for child in map(int, listed):
        words = Path(f"/proc/{child}/cmdline").read_bytes().split(b"\0")
        found[words[3].decode()] = child
    return found


def ended(descriptor: int) -> bool:
    """Wait for the end of a process."""
    poll = select.poll()
    poll.register(descriptor, select.POLLIN)
    try:
        return bool(poll.poll(60_000))
    finally:
        os.close(descriptor)
