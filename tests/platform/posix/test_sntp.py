# SPDX-License-Identifier: Apache-2.0
"""SNTP over UDP: with Debian's chrony as the server, and with servers that lie."""

from __future__ import annotations

import os
import shutil
import socket
import struct
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from safety_island.platform.posix.clock import PosixClock
from safety_island.platform.posix.sntp import synchronise
from safety_island.platform.sntp import SntpError
from tests.platform.test_sntp import ntp

CHRONYD = shutil.which("chronyd", path=f"{os.environ.get('PATH', '')}:/usr/sbin")
Answer = Callable[[bytes], list[bytes]]


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as channel:
        channel.bind(("127.0.0.1", 0))
        return int(channel.getsockname()[1])


@contextmanager
def chrony(folder: Path, *extra: str) -> Iterator[str]:
    """Run chrony on a port of its own; it leaves the machine's clock alone (-x)."""
    port = free_port()
    settings = [f"port {port}", "bindaddress 127.0.0.1", "cmdport 0", "bindcmdaddress /", "allow"]
    config = folder / "chrony.conf"
    config.write_text("\n".join([*settings, f"pidfile {folder}/pid", *extra]) + "\n")
    command = [str(CHRONYD), "-d", "-x", "-U", "-u", "root", "-f", str(config)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            said = []
            for line in process.stderr:
                said.append(line)
                if "Disabled control of system clock" in line:
                    break
            else:
                pytest.fail(f"chrony ended: {said}")
            wait_until_taken(port)
            yield f"127.0.0.1:{port}"
        finally:
            process.terminate()


def wait_until_taken(port: int) -> None:
    """Wait until a server holds a UDP port; chrony opens it some time after its first lines."""
    limit = time.monotonic() + 30
    while time.monotonic() < limit:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                return
        time.sleep(0.01)
    pytest.fail(f"nobody opened UDP port {port}")


@contextmanager
def server(answer: Answer) -> Iterator[str]:
    """Answer one request with the datagrams that ``answer`` makes of it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as channel:
        channel.bind(("127.0.0.1", 0))
        channel.settimeout(30)

        def serve() -> None:
            data, address = channel.recvfrom(1024)
            for reply in answer(data):
                channel.sendto(reply, address)

        thread = threading.Thread(target=serve)
        thread.start()
        yield f"127.0.0.1:{channel.getsockname()[1]}"
        thread.join()


def reply(data: bytes, shift_s: float = 0.0, flags: int = 0x24, stratum: int = 1) -> bytes:
    """An answer that is right apart from what the arguments say."""
    now = ntp(time.time_ns() + round(shift_s * 1e9))
    head = struct.pack(">BBbbII4s", flags, stratum, 6, -20, 0, 0, b"TEST")
    return head + struct.pack(">Q8sQQ", now, data[40:48], now, now)


@pytest.mark.skipif(CHRONYD is None, reason="chrony is not installed")
def test_chrony_sets_the_wall_clock(tmp_path: Path) -> None:
    clock = PosixClock()
    clock.set_wall_offset_ns(0)
    with chrony(tmp_path, "local stratum 8") as name:
        found = synchronise(clock, name, timeout_s=30.0)
    assert found.stratum == 8
    # chrony serves the machine's own clock, so both must show the same, but for the way there.
    before, shown, after = time.time_ns(), clock.wall_ns(), time.time_ns()
    slack = found.round_trip_ns + 1_000_000
    assert before - slack <= shown <= after + slack


@pytest.mark.skipif(CHRONYD is None, reason="chrony is not installed")
def test_chrony_without_a_source_is_refused(tmp_path: Path) -> None:
    with chrony(tmp_path) as name, pytest.raises(SntpError, match="not synchronised"):
        synchronise(PosixClock(), name, timeout_s=30.0)


def test_another_time_moves_the_wall_clock_and_nothing_else() -> None:
    clock = PosixClock()
    with server(lambda data: [reply(data, shift_s=86400.0)]) as name:
        machine, monotonic = time.time_ns(), time.monotonic_ns()
        found = synchronise(clock, name)
    ahead = clock.wall_ns() - time.time_ns() - 86400 * 10**9
    assert abs(ahead) < found.round_trip_ns + 1_000_000
    # The machine's clock ran on as the monotonic one did.
    assert abs((time.time_ns() - machine) - (time.monotonic_ns() - monotonic)) < 1_000_000_000


def test_forged_replies_are_passed_over() -> None:
    def answer(data: bytes) -> list[bytes]:
        forged = reply(data[:40] + bytes(8), shift_s=1e6)
        return [b"short", forged, reply(data)]

    clock = PosixClock()
    with server(answer) as name:
        synchronise(clock, name)
    assert abs(clock.wall_ns() - time.time_ns()) < 1_000_000_000


@pytest.mark.parametrize(
    ("answer", "text"),
    [
        (lambda data: [reply(data, stratum=0)], "kiss-o'-death 'TEST'"),
        (lambda data: [reply(data, stratum=16)], "stratum 16"),
        (lambda data: [reply(data, flags=0xE4)], "not synchronised"),
        (lambda data: [reply(data, flags=0x23)], "mode 3"),
        (lambda data: [reply(data, shift_s=-40 * 365 * 86400.0)], "before 2025"),
        (lambda data: [data], "does not repeat"),
        (lambda data: [reply(bytes(48))], "does not repeat"),
        (lambda data: [], "no answer within 0.3 s"),
    ],
)
def test_lies_leave_the_clock_as_it_was(answer: Answer, text: str) -> None:
    clock = PosixClock()
    clock.set_wall_offset_ns(7)
    with server(answer) as name, pytest.raises(SntpError, match=text) as caught:
        synchronise(clock, name, timeout_s=0.3)
    assert str(caught.value).startswith(f"no time from SNTP server '{name}': ")
    assert "--sntp" in str(caught.value)
    assert abs(clock.wall_ns() - time.monotonic_ns()) < 60 * 10**9


def test_nobody_there() -> None:
    with pytest.raises(SntpError, match="Connection refused"):
        synchronise(PosixClock(), f"127.0.0.1:{free_port()}")


def test_unknown_name() -> None:
    with pytest.raises(SntpError, match="cannot be resolved"):
        synchronise(PosixClock(), "no.such.name.invalid")
