# SPDX-License-Identifier: Apache-2.0
"""What a service manager hears, over a real socket."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from safety_island.platform.posix.service import ServiceManager


@pytest.fixture(params=["path", "abstract"])
def manager(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[socket.socket]:
    """The manager's end; the environment names it."""
    path = str(tmp_path / "notify")
    is_path = request.param == "path"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as end:
        end.bind(path if is_path else f"\0{path}")
        end.settimeout(10)
        monkeypatch.setenv("NOTIFY_SOCKET", path if is_path else f"@{path}")
        yield end


def test_start_work_and_end_are_told(manager: socket.socket) -> None:
    service = ServiceManager()
    service.ready()
    service.alive()
    service.stopping()
    heard = [manager.recv(64) for _ in range(3)]
    assert heard == [b"READY=1", b"WATCHDOG=1", b"STOPPING=1"]
    service.close()


def test_a_manager_that_does_not_read_makes_nobody_wait(manager: socket.socket) -> None:
    service = ServiceManager()
    for _ in range(5000):  # more than the queue of any socket holds
        service.ready()
    assert manager.recv(64) == b"READY=1"
    service.close()


@pytest.mark.parametrize(
    ("watchdog_us", "expected"), [("2000000", 10), ("", 10), ("x", 10), ("40000", 100)]
)
def test_signs_of_life_are_sent_now_and_then(
    manager: socket.socket, monkeypatch: pytest.MonkeyPatch, watchdog_us: str, expected: int
) -> None:
    """A hundred rounds in a bit more than a second."""
    monkeypatch.setenv("WATCHDOG_USEC", watchdog_us)
    service = ServiceManager()
    sent: list[bytes] = []
    monkeypatch.setattr(service, "_send", sent.append)
    for tick in range(100):
        monkeypatch.setattr("time.monotonic", lambda tick=tick: 1000.0 + tick * 0.0101)
        service.alive()
    assert sent == [b"WATCHDOG=1"] * expected
    service.close()


def test_a_manager_that_is_gone_ends_nothing(tmp_path: Path) -> None:
    service = ServiceManager(str(tmp_path / "nobody"))
    service.alive()
    service.close()
    service.alive()


def test_without_a_manager_nothing_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NOTIFY_SOCKET", raising=False)
    service = ServiceManager()
    assert service._socket is None
    service.ready()
    service.close()
