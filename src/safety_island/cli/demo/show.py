# SPDX-License-Identifier: Apache-2.0
"""Shows a running demo: as a live view, or as plain lines."""

from __future__ import annotations

import sys
import time
from typing import TextIO

from rich.console import Console
from rich.live import Live

from safety_island.cli.demo.events import DemoState
from safety_island.cli.demo.text import plain_line, waiting_for
from safety_island.cli.demo.view import View
from safety_island.sim.courses import Course

PLAIN_EVERY_S = 1.0


class TerminalShow:
    """Redraws the view in place, in the size that the window has at that moment."""

    def __init__(
        self, course: Course, title: str, console: Console | None = None, *, has_keys: bool = False
    ) -> None:
        self._view = View(course, title, has_keys=has_keys)
        self._console = console or Console()
        self._live = Live(console=self._console, auto_refresh=False)
        self._size = self._console.size

    def __enter__(self) -> TerminalShow:
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def __call__(self, state: DemoState) -> None:
        """Draw."""
        size = self._console.size
        if size != self._size:  # lines of the old width have been wrapped or cut
            self._size = size
            self._console.clear()
        self._live.update(self._view.draw(state, *size), refresh=True)

    def suspend(self) -> None:
        """Leave the terminal to others for a while."""
        self._console.show_cursor(True)

    def resume(self) -> None:
        """Have the terminal back."""
        self._console.show_cursor(False)


class PlainShow:
    """Prints a line a second, and what the processes log."""

    def __init__(self, stream: TextIO = sys.stdout) -> None:
        self._stream = stream
        self._last = ""
        self._next = 0.0
        self._told = 0

    def __enter__(self) -> PlainShow:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def __call__(self, state: DemoState) -> None:
        """Print what is new."""
        for message in state.messages[self._told :]:
            self._print(message)
        self._told = len(state.messages)
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + PLAIN_EVERY_S
        line = plain_line(state) if state.is_driving else f"waiting for {waiting_for(state)}"
        if line != self._last:
            self._last = line
            self._print(line)

    def _print(self, text: str) -> None:
        print(text, file=self._stream, flush=True)
