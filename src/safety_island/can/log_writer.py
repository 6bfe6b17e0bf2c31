# SPDX-License-Identifier: Apache-2.0
"""Writes the frames that were sent to a file that ``canplayer`` and ``cantools decode`` read."""

from __future__ import annotations

import errno
import os
import threading
from collections.abc import Iterable
from pathlib import Path
from queue import SimpleQueue

from safety_island.can.candump import format_line
from safety_island.errors import ConfigurationError
from safety_island.platform.interfaces import CanFrame, Logger

CAPACITY = 1024
"""Commands that may wait for a slow disk; more are dropped and counted."""
CLOSE_LIMIT_S = 0.5

_Entry = tuple[int, tuple[CanFrame, ...]]


class CanLogWriter:
    """A log in the form of ``candump -L``; a thread writes it, so no tick waits for a disk.

    ``channel``: the interface that each line names. The time of a line is the stamp of its command.
    Raises ConfigurationError when the file cannot be opened.
    """

    def __init__(self, path: Path, logger: Logger, channel: str = "can0") -> None:
        self.path = path
        self.dropped = 0
        """Commands that are not in the file: it was too slow, or failed."""
        self._logger = logger
        self._channel = channel
        self._descriptor = _open(path)
        self._entries: SimpleQueue[_Entry | None] = SimpleQueue()
        self._has_failed = False
        self._thread = threading.Thread(target=self._run, name="can-log", daemon=True)
        self._thread.start()

    def record(self, stamp_ns: int, frames: Iterable[CanFrame]) -> None:
        """Note the frames of a command, stamped [ns]; never waits."""
        if self._has_failed or self._entries.qsize() >= CAPACITY:
            self.dropped += 1
        else:
            self._entries.put((stamp_ns, tuple(frames)))

    def close(self) -> None:
        """Write what is queued, within a short limit."""
        self._entries.put(None)
        self._thread.join(CLOSE_LIMIT_S)
        if self.dropped:
            self._logger.warning("%s lacks %d commands", self.path, self.dropped)

    def _run(self) -> None:
        while (entry := self._entries.get()) is not None:
            self._write(entry)
        os.close(self._descriptor)

    def _write(self, entry: _Entry) -> None:
        if self._has_failed:
            self.dropped += 1
            return
        stamp_ns, frames = entry
        data = "".join(format_line(stamp_ns, self._channel, frame) for frame in frames).encode()
        try:
            while data:
                data = data[os.write(self._descriptor, data) :]
        except OSError as error:
            self._has_failed = True
            self.dropped += 1
            self._logger.error("%s is not written any more: %s", self.path, error.strerror)


def _open(path: Path) -> int:
    # Without O_NONBLOCK, opening a pipe that nobody reads would wait for ever.
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC
    try:
        descriptor = os.open(path, flags | os.O_NONBLOCK, 0o666)
    except OSError as error:
        reason = "nobody reads the pipe" if error.errno == errno.ENXIO else error.strerror
        raise ConfigurationError(f"--can-log {path}: cannot be written: {reason}") from error
    os.set_blocking(descriptor, True)
    return descriptor
