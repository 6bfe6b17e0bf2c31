# SPDX-License-Identifier: Apache-2.0
"""Shows statuses as they come: as a live view, as plain lines, or as JSON lines."""

from __future__ import annotations

import json
import sys
from typing import Protocol, Self, TextIO

from rich.console import Console
from rich.live import Live

from safety_island.cli.jsonlines import HEAD
from safety_island.cli.status.text import plain_line
from safety_island.cli.status.view import draw
from safety_island.messages.status_fields import Status
from safety_island.status.values import status_values
from safety_island.status.why import held_by

DRAW_EVERY_S = 0.1
PLAIN_EVERY_S = 1.0


class Show(Protocol):
    """Told of the statuses that came, ten times a second also when none did."""

    def __enter__(self) -> Self: ...

    def __exit__(self, *_: object) -> None: ...

    def __call__(self, statuses: list[Status], now: float) -> None:
        """Show them; ``now`` is the monotonic clock [s]."""


class TerminalShow:
    """Redraws the view in place."""

    def __init__(self, title: str, now: float, console: Console | None = None) -> None:
        self._title = title
        self._newest: Status | None = None
        self._came_at = now
        self._drawn_at = -DRAW_EVERY_S
        self._live = Live(console=console or Console(), auto_refresh=False)

    def __enter__(self) -> Self:
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def __call__(self, statuses: list[Status], now: float) -> None:
        """Draw the newest."""
        if statuses:
            self._newest, self._came_at = statuses[-1], now
        if now >= self._drawn_at + DRAW_EVERY_S:
            self._drawn_at = now
            view = draw(self._newest, now - self._came_at, self._title)
            self._live.update(view, refresh=True)


class PlainShow:
    """Prints a line a second, and at once when state or reason change."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stdout
        self._next = 0.0
        self._last: tuple[int, int] | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def __call__(self, statuses: list[Status], now: float) -> None:
        """Print what is new."""
        for status in statuses:
            is_news = (status.state, status.reason) != self._last
            if is_news or now >= self._next:
                self._last = (status.state, status.reason)
                self._next = now + PLAIN_EVERY_S
                print(plain_line(status), file=self._stream, flush=True)


class JsonShow(PlainShow):
    """Prints each status as a JSON object; the first one says which version wrote it."""

    _head = HEAD

    def __call__(self, statuses: list[Status], now: float) -> None:
        """Print all."""
        for status in statuses:
            values = status_values(status) | {"held_by": held_by([status])}
            line = json.dumps({"event": "status", **self._head, **values}, allow_nan=False)
            self._head = {}
            print(line, file=self._stream, flush=True)
