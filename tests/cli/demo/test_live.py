"""The demo as a person starts it: three processes on loopback."""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import sys
from pathlib import Path

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
        assert set(children) == {"run", "bridge", "main-compute"}
        os.kill(children[victim], signal.SIGKILL)
        _, error = process.communicate(timeout=60)
    name = {"run": "island"}.get(victim, victim)
    assert process.returncode == 1
    assert f"island: error: {name} died (signal SIGKILL)" in error
    assert not any(Path(f"/proc/{pid}").exists() for pid in children.values())


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
