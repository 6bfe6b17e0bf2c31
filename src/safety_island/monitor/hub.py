# SPDX-License-Identifier: Apache-2.0
"""What is on its way to each open page: rows in order, of everything else the newest only."""

from __future__ import annotations

import asyncio
import json
from collections import deque
from collections.abc import Mapping
from typing import Any

from safety_island.monitor.history import History

MOST_ROWS = 200
"""Rows that wait for a slow page; older ones are dropped and counted."""
MOST_MARKS = 100

Message = Mapping[str, Any]


class Client:
    """The messages that wait for one page.

    A page that reads slowly costs this much memory and no more: the sender waits for it, meanwhile
    newer messages take the place of older ones.
    """

    def __init__(self) -> None:
        self.dropped = 0
        """Rows that the page has not received."""
        self.wakeup = asyncio.Event()
        self._rows: deque[list[float | None]] = deque(maxlen=MOST_ROWS)
        self._marks: deque[Message] = deque(maxlen=MOST_MARKS)
        self._newest: dict[str, Message] = {}

    def add_row(self, values: list[float | None]) -> None:
        """Queue the numbers of a tick."""
        self.dropped += len(self._rows) == MOST_ROWS
        self._rows.append(values)
        self.wakeup.set()

    def add_mark(self, mark: Message) -> None:
        """Queue a mark."""
        self._marks.append(mark)
        self.wakeup.set()

    def offer(self, kind: str, message: Message) -> None:
        """Send this message, in place of one of its kind that still waits."""
        self._newest.pop(kind, None)  # the newest of all comes last
        self._newest[kind] = message
        self.wakeup.set()

    def take(self) -> str:
        """Return all that waits as one JSON array; nothing waits afterwards."""
        self.wakeup.clear()
        found: list[Message] = []
        if self._rows:
            found.append({"kind": "rows", "rows": list(self._rows), "dropped": self.dropped})
        found += self._marks
        found += self._newest.values()
        self._rows.clear()
        self._marks.clear()
        self._newest.clear()
        return _json(found)


class Hub:
    """Everything that the pages show; told by the feed, read by the clients."""

    def __init__(self, hello: Message) -> None:
        self.hello = hello
        self.history = History()
        self.clients: set[Client] = set()
        self._newest: dict[str, Message] = {}

    def add_row(self, values: list[float], sent: list[float | None]) -> None:
        """Keep the numbers of a tick and send them to every page."""
        self.history.add(values)
        for client in self.clients:
            client.add_row(sent)

    def add_mark(self, t: float, text: str, kind: str) -> None:
        """Mark a moment: ``kind`` is ``state``, ``fault`` or ``reaction``."""
        mark = {"kind": "mark", "t": round(t, 3), "text": text, "of": kind}
        self.history.marks.append(mark)
        for client in self.clients:
            client.add_mark(mark)

    def publish(self, kind: str, values: Message) -> None:
        """Keep the newest message of a kind and send it to every page."""
        message = {"kind": kind, **values}
        self._newest.pop(kind, None)
        self._newest[kind] = message
        for client in self.clients:
            client.offer(kind, message)

    def join(self) -> tuple[Client, list[str]]:
        """Return a new client, and the messages that bring its page up to date."""
        client = Client()
        self.clients.add(client)
        marks = list(self.history.marks)
        messages = [_json([{"kind": "hello", **self.hello}])]
        messages += [_json([{"kind": "rows", "rows": rows}]) for rows in self.history.chunks()]
        messages.append(_json([*marks, *self._newest.values()]))
        return client, messages

    def leave(self, client: Client) -> None:
        """Forget a client."""
        self.clients.discard(client)


def _json(messages: list[Message]) -> str:
    return json.dumps(messages, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
