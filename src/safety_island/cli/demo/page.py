# SPDX-License-Identifier: Apache-2.0
"""Tells the page what the demo knows: its buttons, marks of what happened, CAN frames."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence

from safety_island.cli.demo.actions import Processes
from safety_island.cli.demo.events import PAGE

Buttons = Callable[[], Sequence[Mapping[str, object]]]


class PageLines:
    """Writes lines to the monitor's standard input; ``look`` sends what is new."""

    def __init__(self, processes: Processes, buttons: Buttons) -> None:
        self._processes, self._buttons = processes, buttons
        self._told = 0
        self._shown: Sequence[Mapping[str, object]] | None = None
        self._can: object = None

    def look(self) -> None:
        """Send what is new since the last call."""
        state = self._processes.state
        if not state.page:  # it does not listen yet, or has ended
            return
        if (buttons := self._buttons()) != self._shown:
            self._shown = buttons
            self._say({"event": "buttons", "buttons": buttons})
        for event in state.events[self._told :]:
            kind = "reaction" if event.is_reaction else "fault"
            self._say({"event": "mark", "text": event.text, "of": kind})
        self._told = len(state.events)
        can = state.tick.get("can")
        if can and can != self._can:
            self._can = can
            self._say({"event": "can", "can": can})

    def _say(self, line: Mapping[str, object]) -> None:
        page = self._processes.find(PAGE)
        if page is not None:
            page.say(json.dumps(line))
