# SPDX-License-Identifier: Apache-2.0
"""Single keys from a terminal, whose mode is restored however the demo ends."""

from __future__ import annotations

import contextlib
import os
import signal
import termios
from collections.abc import Callable
from types import FrameType
from typing import Any, Self

_LOCAL_FLAGS = 3
"""Index of the local flags in what ``termios`` gives."""


_Handler = Callable[[int, FrameType | None], None]


def _nothing() -> None:
    """Do nothing."""


class Keyboard:
    """A context in which a terminal gives every key at once and echoes none.

    Ctrl-C, Ctrl-Z and Ctrl-\\ stay signals. While the process is suspended, and when it is ended
    by SIGQUIT, the terminal has its own mode; ``on_suspend`` and ``on_resume`` are called around
    that. In the background nothing is read and no mode is set.
    """

    def __init__(
        self,
        descriptor: int,
        on_suspend: Callable[[], None] = _nothing,
        on_resume: Callable[[], None] = _nothing,
    ) -> None:
        self.descriptor = descriptor
        self._on_suspend, self._on_resume = on_suspend, on_resume
        self._handlers: dict[signal.Signals, Any] = {}

    def __enter__(self) -> Self:
        self._mode = termios.tcgetattr(self.descriptor)
        handlers: dict[signal.Signals, _Handler] = {
            signal.SIGTSTP: self._suspend,
            signal.SIGCONT: self._resume,
            signal.SIGQUIT: self._quit,
        }
        for number, handler in handlers.items():
            self._handlers[number] = signal.signal(number, handler)
        self._set_keys()
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        self._restore()

    def read(self) -> str:
        """Return the keys that were pressed; None came: empty. Raises EOFError at a hang-up."""
        if not self._is_foreground():
            return ""
        try:
            data = os.read(self.descriptor, 64)
        except OSError as error:
            raise EOFError from error
        if not data:
            raise EOFError
        return "" if data.startswith(b"\x1b") else data.decode("ascii", errors="ignore")

    def _is_foreground(self) -> bool:
        """Whether this process may use the terminal; to touch it from the background stops it."""
        try:
            return os.tcgetpgrp(self.descriptor) == os.getpgrp()
        except OSError:  # not its controlling terminal: nobody is stopped for that
            return True

    def _set_keys(self) -> None:
        if self._is_foreground():
            mode = list(self._mode)
            mode[_LOCAL_FLAGS] &= ~(termios.ICANON | termios.ECHO)
            self._apply(mode)

    def _restore(self) -> None:
        if self._is_foreground():
            self._apply(self._mode)

    def _apply(self, mode: list[Any]) -> None:
        with contextlib.suppress(termios.error):  # the terminal has gone
            termios.tcsetattr(self.descriptor, termios.TCSADRAIN, mode)

    def _suspend(self, number: int, _: FrameType | None) -> None:
        self._on_suspend()
        self._restore()
        self._take_default(number)
        signal.signal(number, self._suspend)  # here it goes on, after SIGCONT

    def _resume(self, number: int, _: FrameType | None) -> None:
        self._set_keys()
        self._on_resume()

    def _quit(self, number: int, _: FrameType | None) -> None:
        self._on_suspend()
        self._restore()
        self._take_default(number)

    def _take_default(self, number: int) -> None:
        signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)
