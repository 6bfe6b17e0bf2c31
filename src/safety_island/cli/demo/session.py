# SPDX-License-Identifier: Apache-2.0
"""Runs the processes of the demo until the course is driven, time is up, or one dies."""

from __future__ import annotations

import math
import re
import selectors
import time
from collections.abc import Callable, Sequence

from safety_island.cli.browser import open_page
from safety_island.cli.demo.child import Child, how_it_ended
from safety_island.cli.demo.events import (
    ARM,
    BRIDGE,
    ISLAND,
    PAGE,
    SECOND_ISLAND,
    VEHICLE,
    DemoState,
)
from safety_island.cli.demo.keyboard import Keyboard
from safety_island.cli.demo.text import waiting_for
from safety_island.cli.stopping import StopFlag
from safety_island.errors import IslandError

REFRESH_S = 0.1
_LOG_HEAD = re.compile(r"\[INFO\] \[[\d.]+\] \[[^]]*\] ")
START_LIMIT_S = 60.0
"""The vehicle must drive by then; compiled code is there before the processes start."""

SUMMARY_LIMIT_S = 2.0
"""Within this time [s] the main compute reports how the drive went when it is asked to end."""

LEAVE_LIMIT_S = 1.0
"""Time [s] in which the island learns that autonomous mode was left, before it is ended."""

_ORDER = (ARM, SECOND_ISLAND, ISLAND, BRIDGE, VEHICLE, PAGE)
"""Who leaves first at the end: a process that is still there misses no input."""


class DemoError(IslandError):
    """A process of the demo died, or the vehicle never moved."""


class Session:
    """Some children, one state, one loop; ``show`` is called about ten times a second.

    The demo ends in order when the main compute reports its summary, or when ``stop`` is set.
    After ``limit_s`` [s] of driving the main compute is asked to end. ``on_keys`` is told what
    comes from the ``keyboard``, ``on_button`` of each button of the page; ``look`` is called with
    the time [s] after whatever came.
    """

    def __init__(
        self,
        children: Sequence[Child],
        show: Callable[[DemoState], None],
        limit_s: float = math.inf,
        stop: StopFlag | None = None,
    ) -> None:
        self.state = DemoState()
        self.keyboard: Keyboard | None = None
        self.on_keys: Callable[[str], None] = lambda keys: None
        self.opens_page = False
        """Whether the page is opened in the browser of the desktop, once it is served."""
        self.on_button: Callable[[str], None] = lambda key: None
        self.look: Callable[[float], None] = lambda now: None
        self._children, self._running = list(children), list[Child]()
        self._show = show
        self._limit_s = limit_s
        self._driven_since: float | None = None
        self._stop = stop or StopFlag()
        self._selector = selectors.DefaultSelector()

    def run(self) -> None:
        """Run to the end; raise DemoError when a child dies or nothing happens.

        Whatever ends it, all children have ended afterwards and their last words are in ``state``.
        """
        self._started = self._shown = time.monotonic()
        try:
            for child in self._children:
                self.add(child)
            if self.keyboard is not None:
                self._selector.register(self.keyboard.descriptor, selectors.EVENT_READ)
            self._until(self._has_ended)
            self._leave()
        finally:
            self._end()
            self._selector.close()

    def find(self, name: str) -> Child | None:
        """Return the running child of that name."""
        return next((child for child in self._running if child.name == name), None)

    def add(self, child: Child) -> None:
        """Start a child."""
        child.start()
        self._running.append(child)
        for stream in child.streams:
            self._selector.register(stream, selectors.EVENT_READ)

    def drop(self, child: Child, *, kill: bool = False) -> None:
        """End a child whose end is no failure of the demo, in order or by SIGKILL."""
        (child.kill if kill else child.tell_to_stop)()
        child.wait()
        self._read([child])
        self._running.remove(child)
        for stream in child.streams:
            self._selector.unregister(stream)
        child.close()

    def end(self) -> None:
        """End the demo in order."""
        self._stop.set()

    def lift_limit(self) -> None:
        """Let the drive take as long as it needs."""
        self._limit_s = math.inf

    def _until(self, is_over: Callable[[], bool]) -> None:
        """Read, show and obey until something is over."""
        while not is_over():
            ready = self._selector.select(REFRESH_S)
            self._read(self._running)
            if self.opens_page and self.state.page:
                self.opens_page = False
                open_page(self.state.page)
            while self.state.pressed:
                self.on_button(self.state.pressed.pop(0))
            self.look(time.monotonic())
            keyboard = self.keyboard
            if keyboard is not None and any(key.fd == keyboard.descriptor for key, _ in ready):
                self._take_keys(keyboard)
            self._tell()

    def _take_keys(self, keyboard: Keyboard) -> None:
        try:
            self.on_keys(keyboard.read())
        except EOFError:
            self._selector.unregister(keyboard.descriptor)

    def _read(self, children: Sequence[Child]) -> None:
        for child in children:
            known = len(child.said)
            for event in child.events():
                self.state.update(child.name, event)
            self.state.messages += [f"{child.name}: {bare(line)}" for line in child.said[known:]]
        if self._driven_since is None and self.state.is_driving:
            self._driven_since = time.monotonic()

    def _has_ended(self) -> bool:
        """Whether the drive has come to its end; raise DemoError when a process has before."""
        for child in list(self._running):
            code = child.exit_code
            if code is None:
                continue
            if child.name == ARM:  # it answers and ends, whatever the answer
                self.drop(child)
            elif child.name == PAGE:
                self._lose_page(child, code)
            elif child.name != VEHICLE or code != 0:
                self._read(self._running)
                words = next((line for line in reversed(child.said) if line.strip()), "")
                last = f"; it said: {words}" if words else ""
                raise DemoError(f"{child.name} died ({how_it_ended(code)}){last}")
            else:
                return True
        return self._stop.is_set() or bool(self.state.vehicle_summary)

    def _lose_page(self, child: Child, code: int) -> None:
        """The drive goes on without the page."""
        self.drop(child)
        words = f": {child.said[-1]}" if child.said else ""
        self.state.page = ""
        self.state.messages.append(
            f"the page has ended ({how_it_ended(code)}{words}); the drive goes on without it"
        )

    def _tell(self) -> None:
        now = time.monotonic()
        if now - self._shown >= REFRESH_S:
            self._shown = now
            self._show(self.state)
        if self._driven_since is not None:
            if now - self._driven_since > self._limit_s:
                self.lift_limit()
                self._ask_for_summary()
        elif now - self._started > START_LIMIT_S and not self._stop.is_set():
            raise DemoError(
                f"the vehicle did not move within {START_LIMIT_S:g} s:"
                f" waiting for {waiting_for(self.state)}"
            )

    def _ask_for_summary(self) -> None:
        vehicle = self.find(VEHICLE)
        if vehicle is None:
            return
        if vehicle.is_controlled:
            vehicle.say("end")
        else:
            vehicle.tell_to_stop()

    def _leave(self) -> None:
        """Let the main compute leave autonomous mode, and the island see it, before all end."""
        if not self.state.has_driven:
            return
        if not self.state.vehicle_summary:
            self._ask_for_summary()
            self._wait(SUMMARY_LIMIT_S, lambda: bool(self.state.vehicle_summary))
        if self.find(BRIDGE) is not None:
            self._wait(LEAVE_LIMIT_S, lambda: self.state.tick.get("state") != "ACTIVE")

    def _wait(self, limit_s: float, holds: Callable[[], bool]) -> None:
        end = time.monotonic() + limit_s
        self._until(lambda: holds() or time.monotonic() > end)

    def _end(self) -> None:
        """End all children, in their order."""
        for child in sorted(self._running, key=lambda child: _ORDER.index(child.name)):
            child.tell_to_stop()
            child.wait()
        self._read(self._running)
        for child in self._running:
            child.close()


def bare(line: str) -> str:
    """Return a line without the head of an ordinary log line."""
    return _LOG_HEAD.sub("", line, count=1)
