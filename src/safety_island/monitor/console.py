# SPDX-License-Identifier: Apache-2.0
"""Lines on standard input: what the program that started the monitor adds to the page.

Each is a JSON object with ``event``: ``buttons`` (which there are), ``mark`` (a moment on all
plots), ``can`` (the frames of a command, decoded). The end of the input ends the monitor.
"""

from __future__ import annotations

import json
import os
import select
from typing import Any

from safety_island.monitor.hub import Hub

MARKS = ("fault", "reaction", "state")


class Console:
    """Reads lines without ever waiting for them."""

    def __init__(self, descriptor: int = 0) -> None:
        self.is_closed = False
        """Whether the input has come to its end."""
        self._descriptor, self._rest = descriptor, b""
        self._poll = select.poll()
        self._poll.register(descriptor, select.POLLIN)

    def poll(self, hub: Hub, now: float) -> None:
        """Obey the lines that have come; ``now`` [s] is the moment of what they mark."""
        while not self.is_closed and self._poll.poll(0):
            data = os.read(self._descriptor, 65536)
            if not data:
                self.is_closed = True
                return
            *lines, self._rest = (self._rest + data).split(b"\n")
            for line in lines:
                _obey(hub, now, json.loads(line))


def _obey(hub: Hub, now: float, line: dict[str, Any]) -> None:
    match line:
        case {"event": "mark", "text": str(text), "of": str(kind)} if kind in MARKS:
            hub.add_mark(now, text, kind)
        case {"event": "buttons", "buttons": list(buttons)}:
            hub.publish("buttons", {"buttons": buttons})
        case {"event": "can", "can": dict(frames)}:
            hub.publish("can", {"t": round(now, 3), "can": frames})
