# SPDX-License-Identifier: Apache-2.0
"""Island and bridge under load, and as services, as real processes."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from safety_island.dds import topics
from safety_island.life_cycle.state import State
from safety_island.platform.posix.real_time import BRIDGE as BRIDGE_PRIORITIES
from safety_island.platform.posix.real_time import ISLAND as ISLAND_PRIORITIES
from safety_island.platform.posix.real_time import Priorities
from tests.live.scene import BRIDGE, ISLAND, VEHICLE, Scene
from tests.platform.posix.test_real_time import may_take_it

pytestmark = pytest.mark.live
needs_right = pytest.mark.skipif(not may_take_it(), reason="needs the right to SCHED_FIFO")
HOGS = 4
HOG = "while True: sum(range(2000))"
TICKS = 200


def start(scene: Scene, name: str, *options: str) -> None:
    scene._commands[name] += options
    scene.start(name)


def priorities(process: subprocess.Popen[bytes]) -> list[int]:
    """The fixed priority of each thread (0: none), that of the control thread first."""
    threads = sorted(int(one.name) for one in Path(f"/proc/{process.pid}/task").iterdir())
    assert threads[0] == process.pid
    return [os.sched_getparam(thread).sched_priority for thread in threads]


@needs_right
@pytest.mark.parametrize(
    ("name", "expected"), [(ISLAND, ISLAND_PRIORITIES), (BRIDGE, BRIDGE_PRIORITIES)]
)
def test_row_95_control_comes_first_and_the_threads_that_bring_its_inputs_next(
    scene: Scene, tmp_path: Path, name: str, expected: Priorities
) -> None:
    """None of them is left where ordinary work can keep it from running."""
    scene.start(name)
    log = tmp_path / f"{name}.log"
    scene.until(lambda: "real time: SCHED_FIFO" in log.read_text("utf-8"), "it says what it got")
    found = priorities(scene._running[name])
    assert found[0] == expected.control
    assert len(found) > 4 and set(found[1:]) == {expected.others}


def test_off_takes_nothing_and_says_nothing(scene: Scene, tmp_path: Path) -> None:
    start(scene, ISLAND, "--realtime", "off")
    log = tmp_path / f"{ISLAND}.log"
    scene.until(lambda: "is live" in log.read_text("utf-8"), "it is live")
    assert set(priorities(scene._running[ISLAND])) == {0}
    assert "real time" not in log.read_text("utf-8")


class Load(NamedTuple):
    """What became of some ticks under load."""

    missed: int
    latest_ms: float
    left_active: bool


@pytest.fixture
def hogs() -> Iterator[list[subprocess.Popen[bytes]]]:
    """Programs that want every processor; those that a test starts are ended."""
    running: list[subprocess.Popen[bytes]] = []
    yield running
    for hog in running:
        hog.kill()
        hog.wait()


def under_load(scene: Scene, hogs: list[subprocess.Popen[bytes]], mode: str) -> Load:
    """Drive at 30 ms, then start the hogs and watch some ticks."""
    for name, options in ((ISLAND, ["--period", "0.03"]), (BRIDGE, [])):
        start(scene, name, *options, "--realtime", mode)
    scene.start(VEHICLE)
    scene.moves()
    before = scene.state(State.ACTIVE).message
    hogs += [subprocess.Popen([sys.executable, "-c", HOG]) for _ in range(HOGS)]
    heard = scene.island.heard[topics.STATUS]
    known = len(heard)
    last = scene.status(lambda s: s.tick >= before.tick + TICKS, "ticks go by").message
    messages = [one.message for one in heard[known:]]
    late = max(message.lateness for message in messages) * 1e3
    left = any(message.state != State.ACTIVE for message in messages)
    missed = last.missed_periods_total - before.missed_periods_total
    return Load(missed, late, left)


@needs_right
@pytest.mark.slow
def test_row_95_under_load_no_more_ticks_are_missed_than_without_real_time(
    scene: Scene, hogs: list[subprocess.Popen[bytes]], tmp_path_factory: pytest.TempPathFactory
) -> None:
    """And the drive goes on. How much better it is depends on the machine; run with -s to see."""
    with_it = under_load(scene, hogs, "auto")
    for hog in hogs:
        hog.kill()
    scene.close()
    again = Scene(scene.domains, tmp_path_factory.mktemp("without"))
    try:
        without = under_load(again, hogs, "off")
    finally:
        again.close()
    print(f"of {TICKS} ticks under {HOGS} hogs: with {with_it}, without {without}")
    assert not with_it.left_active
    assert with_it.missed <= without.missed


class Manager:
    """The end of a service manager."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "notify"
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(str(self.path))
        self._socket.setblocking(False)
        self.heard: list[bytes] = []

    def listen(self) -> None:
        """Take what came."""
        try:
            while True:
                self.heard.append(self._socket.recv(256))
        except BlockingIOError:
            return

    def close(self) -> None:
        self._socket.close()


@pytest.fixture
def manager(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Manager]:
    """A manager that the environment of every process names."""
    manager = Manager(tmp_path)
    monkeypatch.setenv("NOTIFY_SOCKET", str(manager.path))
    yield manager
    manager.close()


@pytest.mark.parametrize("name", [ISLAND, BRIDGE])
def test_a_service_manager_hears_of_start_work_and_end(
    scene: Scene, manager: Manager, name: str
) -> None:
    """An island without inputs is silent, and well: starting it anew would not help."""
    scene.meanwhile = manager.listen
    scene.start(name)
    scene.until(lambda: manager.heard.count(b"WATCHDOG=1") >= 3, "it is alive")
    scene.signal(name, signal.SIGTERM)
    scene.until(lambda: scene._running[name].poll() is not None, "it ends")
    manager.listen()
    assert manager.heard[0] == b"READY=1" and manager.heard.count(b"READY=1") == 1
    assert set(manager.heard) == {b"READY=1", b"WATCHDOG=1", b"STOPPING=1"}
    assert manager.heard[-1] == b"STOPPING=1"
