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
        self.stopping = False
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
        """Tick every ``period_s`` until ``stop``, SIGINT or SIGTERM, or for ``duration_s``.

        A tick that has begun is finished. Call from the main thread, else signals are not heard.
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
        while not self.stopping and last_ns < end_ns:
            due = timer.wait()
            if due is None:
                continue
            self.on_tick(due)
            last_ns = due.due_ns
            if timer.ticks % COLLECT_EVERY == 0:
                gc.collect(1)
        self._wake = self._nothing
        self.logger.info("%s ends after %d ticks, %d missed", self.name, timer.ticks, timer.skipped)
        timer.close()

    def stop(self) -> None:
        """End ``run`` after the present tick; may be called by a signal handler."""
        self.stopping = True
        self._wake()

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
