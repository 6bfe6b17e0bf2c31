# SPDX-License-Identifier: Apache-2.0
"""The log of what was sent: what other tools read of it, and a disk that is full or slow."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import can
import pytest

from safety_island.can import log_writer
from safety_island.can.dbc import dbc_text
from safety_island.can.log_writer import CanLogWriter
from safety_island.errors import ConfigurationError
from tests.can.rig import REFERENCE_LINES, REFERENCE_STAMP_NS, LogLines, triple, until


@pytest.fixture
def log() -> LogLines:
    return LogLines()


def test_lines_of_candump(tmp_path: Path, log: LogLines) -> None:
    writer = CanLogWriter(tmp_path / "sent.log", log)
    writer.record(REFERENCE_STAMP_NS, triple())
    writer.close()
    expected = "".join(f"(0000000012.345000) can0 {line}\n" for line in REFERENCE_LINES)
    assert (tmp_path / "sent.log").read_text() == expected
    assert log.lines == []


def test_python_can_and_canplayer_read_it(tmp_path: Path, log: LogLines) -> None:
    """``canplayer`` wants ``(%lu.%lu) %s %s`` with microseconds; so does python-can's player."""
    path = tmp_path / "sent.log"
    writer = CanLogWriter(path, log, "vcan0")
    writer.record(1_700_000_000_123_456_000, triple())
    writer.close()
    messages = list(can.LogReader(path))
    assert [(m.arbitration_id, bytes(m.data)) for m in messages] == list(triple())
    assert {m.channel for m in messages} == {"vcan0"}
    assert messages[0].timestamp == pytest.approx(1_700_000_000.123456, abs=1e-6)
    for line in path.read_text().splitlines():
        time, channel, frame = line.split(" ")
        seconds, micros = time.strip("()").split(".")
        assert (seconds.isdigit(), len(micros), channel, frame[3]) == (True, 6, "vcan0", "#")


def test_cantools_decodes_it(tmp_path: Path, log: LogLines) -> None:
    (tmp_path / "island.dbc").write_text(dbc_text())
    writer = CanLogWriter(tmp_path / "sent.log", log)
    writer.record(REFERENCE_STAMP_NS, triple())
    writer.close()
    with (tmp_path / "sent.log").open() as lines:
        found = subprocess.run(
            [sys.executable, "-m", "cantools", "decode", "--single-line", tmp_path / "island.dbc"],
            stdin=lines,
            capture_output=True,
            text=True,
            check=True,
        )
    decoded = found.stdout.splitlines()
    assert "steering_tire_angle: 0.125 rad, steering_tire_rotation_rate: -0.5 rad/s" in decoded[0]
    assert "velocity: 12.25 m/s, acceleration: -1.5 m/s^2" in decoded[1]
    assert "mode: DDS_AND_CAN" in decoded[2]
    assert "sequence: 42, timestamp: 12345 ms" in decoded[2]


@pytest.mark.parametrize("name", ["", "no/such/folder.log"])
def test_a_file_that_cannot_be_opened(tmp_path: Path, log: LogLines, name: str) -> None:
    with pytest.raises(ConfigurationError, match=r"^--can-log .*: cannot be written: "):
        CanLogWriter(tmp_path / name, log)


def test_a_pipe_that_nobody_reads_is_an_error_at_the_start(tmp_path: Path, log: LogLines) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ConfigurationError, match="nobody reads the pipe"):
        CanLogWriter(tmp_path / "pipe", log)


@pytest.fixture
def idle_reader(tmp_path: Path) -> Iterator[Path]:
    """A pipe that is open for reading, and not read."""
    path = tmp_path / "pipe"
    os.mkfifo(path)
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    yield path
    os.close(descriptor)


def test_row_65_a_slow_disk_drops_and_counts(
    idle_reader: Path, log: LogLines, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(log_writer, "CLOSE_LIMIT_S", 0.01)
    writer = CanLogWriter(idle_reader, log)
    for _ in range(3000):
        writer.record(REFERENCE_STAMP_NS, triple())
    assert writer.dropped > 0
    writer.close()
    assert log.lines == [f"WARN {idle_reader} lacks {writer.dropped} commands"]


@pytest.fixture
def small_files() -> Iterator[None]:
    """A disk that is full after a kilobyte."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1024, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)
    signal.signal(signal.SIGXFSZ, handler)


@pytest.mark.usefixtures("small_files")
def test_row_64_a_full_disk_ends_the_log_and_nothing_else(tmp_path: Path, log: LogLines) -> None:
    writer = CanLogWriter(tmp_path / "sent.log", log)
    for _ in range(50):
        writer.record(REFERENCE_STAMP_NS, triple())
    assert until(lambda: bool(log.lines))
    assert log.lines == [f"ERROR {tmp_path}/sent.log is not written any more: File too large"]
    dropped = writer.dropped
    writer.record(REFERENCE_STAMP_NS, triple())
    assert writer.dropped >= dropped + 1
    writer.close()
    assert (tmp_path / "sent.log").stat().st_size == 1024
