"""Runs the three processes of the demo until the course is driven, time is up, or one dies."""

from __future__ import annotations

import math
import re
import selectors
import time
from collections.abc import Callable, Sequence

from safety_island.cli.demo.child import Child, how_it_ended
from safety_island.cli.demo.events import VEHICLE, DemoState
from safety_island.cli.demo.text import waiting_for
from safety_island.errors import IslandError

REFRESH_S = 0.1
_LOG_HEAD = re.compile(r"\[INFO\] \[[\d.]+\] \[[^]]*\] ")
START_LIMIT_S = 60.0
"""The vehicle must drive by then; compiled code is there before the processes start."""


class DemoError(IslandError):
    """A process of the demo died, or the vehicle never moved."""


class Session:
    """Some children, one state, one loop; ``show`` is called about ten times a second.

    The demo ends in order when the main compute ends with exit code 0. After ``limit_s`` [s] of
    driving it is told to.
    """

    def __init__(
        self,
        children: Sequence[Child],
        show: Callable[[DemoState], None],
        limit_s: float = math.inf,
    ) -> None:
        self.state = DemoState()
        self._children = children
        self._show = show
        self._limit_s = limit_s
        self._driven_since: float | None = None

    def run(self) -> None:
        """Run to the end; raise DemoError when a child dies or nothing happens.

        Whatever ends it, all children have ended afterwards and their last words are in ``state``.
        """
        self._started = self._shown = time.monotonic()
        running = []
        try:
            for child in self._children:
                child.start()
                running.append(child)
            with selectors.DefaultSelector() as selector:
                for child in running:
                    for stream in child.streams:
                        selector.register(stream, selectors.EVENT_READ)
                while not self._has_ended():
                    selector.select(REFRESH_S)
                    self._read(running)
                    self._tell()
        finally:
            self._end(running)

    def _read(self, running: Sequence[Child]) -> None:
        for child in running:
            known = len(child.said)
            for event in child.events():
                self.state.update(child.name, event)
            self.state.messages += [f"{child.name}: {bare(line)}" for line in child.said[known:]]
        if self._driven_since is None and self.state.is_driving:
            self._driven_since = time.monotonic()

    def _has_ended(self) -> bool:
        """Whether the main compute has come to its end; raise DemoError when another one has."""
        ended = [(child, child.exit_code) for child in self._children]
        for child, code in ended:
            if code is not None and (child.name != VEHICLE or code != 0):
                self._read(self._children)
                words = next((line for line in reversed(child.said) if line.strip()), "")
                last = f"; it said: {words}" if words else ""
                raise DemoError(f"{child.name} died ({how_it_ended(code)}){last}")
        return any(code is not None for _, code in ended)

    def _tell(self) -> None:
        now = time.monotonic()
        if now - self._shown >= REFRESH_S:
            self._shown = now
            self._show(self.state)
        if self._driven_since is not None:
            if now - self._driven_since > self._limit_s:
                self._limit_s = math.inf
                self._named(VEHICLE).tell_to_stop()
        elif now - self._started > START_LIMIT_S:
            raise DemoError(
                f"the vehicle did not move within {START_LIMIT_S:g} s:"
                f" waiting for {waiting_for(self.state)}"
            )

    def _named(self, name: str) -> Child:
        return next(child for child in self._children if child.name == name)

    def _end(self, running: Sequence[Child]) -> None:
        for child in running:
            child.tell_to_stop()
        for child in running:
            child.wait()
        self._read(running)
        for child in running:
            child.close()


def bare(line: str) -> str:
    """Return a line without the head of an ordinary log line."""
    return _LOG_HEAD.sub("", line, count=1)
