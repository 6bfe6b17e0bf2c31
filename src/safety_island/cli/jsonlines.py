# SPDX-License-Identifier: Apache-2.0
"""Writes JSON lines without ever waiting for whoever reads them."""

from __future__ import annotations

import json
import math
import os
import select
from collections.abc import Callable, Mapping

from safety_island import __version__
from safety_island.cli.streams import is_full

MAX_LINE = 4096
"""What a pipe that polls as writable takes at once without blocking (PIPE_BUF of Linux)."""

HEAD: Mapping[str, object] = {"version": __version__}
"""What the first line of a program says beyond its event."""


class JsonLines:
    """One JSON object a line on a file descriptor; a line that would have to wait is dropped.

    The first one that is written has HEAD in it.

    ``dropped`` counts those, and those longer than MAX_LINE. With ``patient`` lines wait for their
    reader: for virtual time, where nobody is in a hurry. When the reader has gone, ``on_lost`` is
    called once with the reason, and nothing more is written: what drives goes on without a reader.
    """

    def __init__(
        self, on_lost: Callable[[str], None], descriptor: int = 1, *, patient: bool = False
    ) -> None:
        self.dropped = 0
        self._head = HEAD
        self._on_lost, self._is_lost = on_lost, False
        self._timeout_ms = None if patient else 0
        self._descriptor = descriptor
        self._poll = select.poll()
        self._poll.register(descriptor, select.POLLOUT)

    def write(self, event: str, values: Mapping[str, object]) -> None:
        """Write one event; a number that is NaN or infinite becomes null."""
        if self._is_lost:
            return
        document = plain({"event": event, **self._head, **values})
        line = json.dumps(document, allow_nan=False).encode() + b"\n"
        try:
            if len(line) <= MAX_LINE and self._poll.poll(self._timeout_ms):
                os.write(self._descriptor, line)
                self._head = {}
            else:
                self.dropped += 1
        except OSError as error:
            self.dropped += 1
            if not is_full(error):
                self._is_lost = True
                self._on_lost(str(error.strerror).lower())


def plain(value: object) -> object:
    """Return a value that JSON has: numbers to 1e-6, null for what is not finite."""
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return round(float(value), 6) if math.isfinite(value) else None
    return value
