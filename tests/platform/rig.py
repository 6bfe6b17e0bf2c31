# SPDX-License-Identifier: Apache-2.0
"""What a contract test needs of a platform besides its interfaces: time that passes, a log sink."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

from safety_island.platform import LogConfig, Logger, Platform, load
from safety_island.platform.posix.logger import PosixLogger
from safety_island.platform.sim import SimPlatform
from safety_island.platform.sim import make as make_sim
from safety_island.platform.sim.logger import MemoryLogger


class Rig(Protocol):
    """One backend under test."""

    interface: str
    """An interface that has an address."""

    @property
    def platform(self) -> Platform:
        """The backend."""

    def busy(self, seconds: float) -> None:
        """Let time pass as a computation of that length would."""

    def later(self, seconds: float, action: Callable[[], None]) -> None:
        """Call ``action`` after a time, while somebody waits."""

    def logger(self, config: LogConfig) -> tuple[Logger, Callable[[], list[str]]]:
        """A logger, and what reads the lines that it wrote."""

    def jammed_logger(self, config: LogConfig) -> Logger:
        """A logger whose sink takes nothing any more."""


class PosixRig:
    """Real time, and files as log sinks."""

    interface: str = "lo"

    def __init__(self, folder: Path) -> None:
        self.platform = load("posix")
        self._path = folder / "log"
        self._file = self._path.open("wb")
        self._pipe = os.pipe()
        self._loggers: list[Logger] = [self.platform.logger]

    def busy(self, seconds: float) -> None:
        end = self.platform.clock.monotonic_ns() + round(seconds * 1e9)
        while self.platform.clock.monotonic_ns() < end:
            pass

    def later(self, seconds: float, action: Callable[[], None]) -> None:
        threading.Timer(seconds, action).start()

    def logger(self, config: LogConfig) -> tuple[Logger, Callable[[], list[str]]]:
        logger = PosixLogger(self.platform.clock, config, self._file.fileno())
        self._loggers.append(logger)

        def lines() -> list[str]:
            assert logger.flush(10.0)
            return self._path.read_text().splitlines()

        return logger, lines

    def jammed_logger(self, config: LogConfig) -> Logger:
        os.set_blocking(self._pipe[1], False)
        while self._fill():
            pass
        os.set_blocking(self._pipe[1], True)
        logger = PosixLogger(self.platform.clock, config, self._pipe[1])
        self._loggers.append(logger)
        return logger

    def _fill(self) -> bool:
        try:
            return os.write(self._pipe[1], bytes(4096)) > 0
        except BlockingIOError:
            return False

    def close(self) -> None:
        os.close(self._pipe[0])  # a jammed writer gets EPIPE and ends
        for logger in self._loggers:
            logger.close()
        os.close(self._pipe[1])
        self._file.close()


class SimRig:
    """Virtual time; the memory logger is its own sink, and jams when it is full."""

    interface: str = "sim0"

    def __init__(self) -> None:
        self.platform: SimPlatform = make_sim()

    def busy(self, seconds: float) -> None:
        clock = self.platform.clock
        clock.advance_to_ns(clock.monotonic_ns() + round(seconds * 1e9))

    def later(self, seconds: float, action: Callable[[], None]) -> None:
        clock = self.platform.clock
        clock.call_at(clock.monotonic_ns() + round(seconds * 1e9), action)

    def logger(self, config: LogConfig) -> tuple[Logger, Callable[[], list[str]]]:
        logger = MemoryLogger(self.platform.clock, config)
        return logger, lambda: [line.rstrip("\n") for line in logger.lines]

    def jammed_logger(self, config: LogConfig) -> Logger:
        return MemoryLogger(self.platform.clock, config)

    def close(self) -> None:
        self.platform.logger.close()


@contextmanager
def open_rig(name: str, folder: Path) -> Iterator[Rig]:
    """The rig of a backend, closed at the end."""
    rig = PosixRig(folder) if name == "posix" else SimRig()
    try:
        yield rig
    finally:
        rig.close()
