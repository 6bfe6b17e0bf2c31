# SPDX-License-Identifier: Apache-2.0
"""A node: publishers, subscriptions and one timer, on any platform and any transport."""

from __future__ import annotations

import gc
import math
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Self

from safety_island.dds.topics import TopicEntry
from safety_island.node.transport import Publisher, Subscription, Transport
from safety_island.platform.interfaces import Platform, Tick

SAME_REQUEST_NS = 200_000_000
"""A shell and ``timeout`` signal a process and its group: two requests so close are one."""
COLLECT_EVERY = 64
"""Ticks between two looks for young garbage, each taken between ticks."""


@contextmanager
def quiet_garbage_collector() -> Iterator[None]:
    """Keep the garbage collector out of the ticks: what exists is never looked at again.

    A collection of everything takes tens of milliseconds and comes when it likes.
    """
    gc.collect()
    gc.freeze()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
        gc.unfreeze()


class Node:
    """Runs ``on_tick`` on a fixed time grid until it is told to stop."""

    def __init__(self, name: str, platform: Platform, transport: Transport) -> None:
        self.name = name
        self.platform = platform
        self.clock = platform.clock
        self.logger = platform.logger
        self.transport = transport
        self.is_ending = False
        """Whether ``run`` was told to end, or has come to the end of its duration."""
        self._stop_ns: int | None = None
        self._is_hurried = False
        self._wake = self._nothing

    def publisher(self, topic: TopicEntry) -> Publisher:
        """Make a publisher of a topic."""
        return self.transport.publisher(topic.name, topic.type_name, topic.qos)

    def subscription(self, topic: TopicEntry) -> Subscription:
        """Make a subscription to a topic."""
        qos = topic.subscription_qos
        return self.transport.subscription(topic.name, topic.type_name, qos)

    def on_tick(self, due: Tick) -> None:
        """Do one tick; ``due`` tells its place on the grid and what was missed before it."""
        raise NotImplementedError

    def run(self, period_s: float, duration_s: float | None = None) -> None:
        """Tick every ``period_s`` until ``stop``, SIGINT, SIGTERM or SIGHUP, or for ``duration_s``.

        A tick that has begun is finished, and then what ``may_end`` waits for. Call from the main
        thread, else no signal arrives.
        """
        with self.platform.on_stop(self.stop), quiet_garbage_collector():
            self._run(period_s, duration_s)

    def _run(self, period_s: float, duration_s: float | None) -> None:
        """Tick on a grid that starts now; what took its time before must not cost the first one."""
        timer = self.platform.new_timer(period_s)
        self._wake = timer.wake
        last_ns = self.clock.monotonic_ns()
        end_ns = math.inf if duration_s is None else last_ns + (duration_s - period_s / 2) * 1e9
        self.logger.info("%s is live, with a period of %g ms", self.name, period_s * 1e3)
        self.is_ending = self._stop_ns is not None or last_ns >= end_ns
        while not (self.is_ending and (self._is_hurried or self.may_end())):
            due = timer.wait()
            if due is None:
                continue
            self.on_tick(due)
            self.is_ending |= due.due_ns >= end_ns
            if timer.ticks % COLLECT_EVERY == 0:
                gc.collect(1)
        self._wake = self._nothing
        self.is_ending = False
        self.logger.info("%s ends after %d ticks, %d missed", self.name, timer.ticks, timer.skipped)
        timer.close()

    def stop(self) -> None:
        """End ``run`` as soon as it may end; a second call ends it after the present tick.

        May be called by a signal handler.
        """
        now_ns = self.clock.monotonic_ns()
        if self._stop_ns is None:
            self._stop_ns = now_ns
        elif now_ns - self._stop_ns > SAME_REQUEST_NS:
            self._is_hurried = True
        self.is_ending = True
        self._wake()

    def may_end(self) -> bool:
        """Whether nothing is left to do before ``run`` ends."""
        return True

    def close(self) -> None:
        """Leave the domain."""
        self.transport.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @staticmethod
    def _nothing() -> None:
        """What ``stop`` wakes while no timer runs."""
