# SPDX-License-Identifier: Apache-2.0
"""SIGINT, SIGTERM, SIGHUP while a command starts up: the process ends at once, with exit code 0.

A handler that raises is not enough: the exception is lost when it hits a callback of the compiler,
and a handler has to wait for library code that runs for seconds. So the interpreter's own C handler
writes into a pipe, and a thread that waits there ends the process.
"""

from __future__ import annotations

import os
import signal
import threading
from types import TracebackType
from typing import Self

from safety_island.platform.signals import stop_signals


class StopAtOnce:
    """A context for the time in which nothing needs an orderly end yet.

    ``disarm`` ends it early: call it when handlers that end the command in order are in place.
    """

    def __enter__(self) -> Self:
        self._reading, self._writing = os.pipe()
        os.set_blocking(self._writing, False)
        self._before = {number: signal.signal(number, _do_nothing) for number in stop_signals()}
        threading.Thread(target=self._watch, name="stop", daemon=True).start()
        self._fd_before = signal.set_wakeup_fd(self._writing, warn_on_full_buffer=False)
        self._armed = True
        return self

    def disarm(self) -> None:
        """Leave signals to their handlers from now on. A second call does nothing."""
        if self._armed:
            self._armed = False
            signal.set_wakeup_fd(self._fd_before)
            os.close(self._writing)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.disarm()
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _watch(self) -> None:
        while number := os.read(self._reading, 1):
            if number[0] in self._before:
                os._exit(0)
        os.close(self._reading)


def _do_nothing(*_: object) -> None:
    """Let the signal reach the pipe and nothing else."""


class StopFlag:
    """Tells a loop to end; ``set`` may be called by a signal handler."""

    def __init__(self) -> None:
        self._is_set = False

    def set(self) -> None:
        """End the loop."""
        self._is_set = True

    def is_set(self) -> bool:
        """Whether to end."""
        return self._is_set
