# SPDX-License-Identifier: Apache-2.0
"""The writing thread: what it does when its sink fails, and how it ends."""

from __future__ import annotations

import os
from pathlib import Path

from safety_island.platform import LogConfig
from safety_island.platform.posix.clock import PosixClock
from safety_island.platform.posix.logger import PosixLogger


def test_dropped_lines_are_told_once_the_sink_takes_lines_again() -> None:
    read_end, write_end = os.pipe()
    logger = PosixLogger(PosixClock(), LogConfig(capacity=4), write_end)
    long = "x" * 70_000  # more than a pipe holds: the writer is stuck in the first line
    for _ in range(20):
        logger.info(long)
    dropped = logger.dropped
    assert dropped >= 15
    received = b""
    while b"dropped" not in received:
        received += os.read(read_end, 1 << 20)
    assert f"{dropped} log lines were dropped".encode() in received
    os.close(read_end)
    logger.close()
    os.close(write_end)


def test_a_sink_that_is_gone_counts_as_dropped() -> None:
    read_end, write_end = os.pipe()
    os.close(read_end)
    logger = PosixLogger(PosixClock(), LogConfig(), write_end)
    logger.info("nobody listens")
    assert logger.flush(10.0)
    assert logger.dropped == 1
    logger.close()
    os.close(write_end)


def test_close_writes_what_is_queued(tmp_path: Path) -> None:
    path = tmp_path / "log"
    with path.open("wb") as sink:
        logger = PosixLogger(PosixClock(), LogConfig(), sink.fileno())
        for count in range(100):
            logger.info("%d", count)
        logger.close()
    assert len(path.read_text().splitlines()) == 100
