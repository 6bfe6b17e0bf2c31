# SPDX-License-Identifier: Apache-2.0
"""The wire between main compute and island: one Wire for each topic, each with its own faults."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from random import Random

from safety_island.dds.qos import Qos
from safety_island.node.memory import MemoryDomain, MemoryPublisher
from safety_island.platform.sim.clock import SimClock

Delivery = tuple[float, bytes]
"""After how much time [s] which bytes arrive."""
Fault = Callable[[bytes], Iterable[Delivery]]
"""From one message that was written to what arrives of it."""

_STAMP = struct.Struct("<iI")
_STAMP_AT = 4
_BODY_AT = 12


def healthy(data: bytes) -> Iterable[Delivery]:
    """Deliver at once, once, whole."""
    return [(0.0, data)]


def drop(data: bytes) -> Iterable[Delivery]:
    """Deliver nothing."""
    return []


def lose(share: float, random: Random) -> Fault:
    """Lose a share of the messages."""
    return lambda data: [] if random.random() < share else [(0.0, data)]


def delay(seconds: float) -> Fault:
    """Deliver later."""
    return lambda data: [(seconds, data)]


def jitter(most_s: float, random: Random) -> Fault:
    """Deliver each message by a time of its own later: they overtake each other."""
    return lambda data: [(random.uniform(0.0, most_s), data)]


def duplicate(after_s: float = 0.0) -> Fault:
    """Deliver twice."""
    return lambda data: [(0.0, data), (after_s, data)]


def swap() -> Fault:
    """Deliver each pair of messages in the wrong order."""
    kept: list[bytes] = []

    def fault(data: bytes) -> Iterable[Delivery]:
        if not kept:
            kept.append(data)
            return []
        return [(0.0, data), (0.0, kept.pop())]

    return fault


def keep(messages: list[bytes]) -> Fault:
    """Keep the messages back in a list."""

    def fault(data: bytes) -> Iterable[Delivery]:
        messages.append(data)
        return []

    return fault


def divert(write: Callable[[bytes], bool]) -> Fault:
    """Let another writer say it."""

    def fault(data: bytes) -> Iterable[Delivery]:
        write(data)
        return []

    return fault


def bursts(count: int) -> Fault:
    """Keep messages until there are so many, then deliver them at once."""
    kept: list[bytes] = []

    def fault(data: bytes) -> Iterable[Delivery]:
        kept.append(data)
        if len(kept) < count:
            return []
        burst = [(0.0, one) for one in kept]
        kept.clear()
        return burst

    return fault


def change(edit: Callable[[bytes], bytes]) -> Fault:
    """Deliver other bytes."""
    return lambda data: [(0.0, edit(data))]


def once(first: Fault) -> Fault:
    """Let a fault happen to one message; the next ones are delivered as they are."""
    rest = [first]
    return lambda data: rest.pop()(data) if rest else healthy(data)


def frozen_stamp() -> Fault:
    """Give every message the stamp of the first one."""
    held: list[bytes] = []

    def edit(data: bytes) -> bytes:
        held.append(data[_STAMP_AT:_BODY_AT])
        return data[:_STAMP_AT] + held[0] + data[_BODY_AT:]

    return change(edit)


def frozen_content() -> Fault:
    """Give every message the content of the first one, under its own stamp."""
    held: list[bytes] = []

    def edit(data: bytes) -> bytes:
        held.append(data[_BODY_AT:])
        return data[:_BODY_AT] + held[0]

    return change(edit)


def stamped(sec: int, nanosec: int) -> Fault:
    """Give every message this stamp."""
    stamp = _STAMP.pack(sec, nanosec)
    return change(lambda data: data[:_STAMP_AT] + stamp + data[_BODY_AT:])


class Wire:
    """A publisher of the main compute whose messages meet ``fault`` on their way."""

    def __init__(
        self, domain: MemoryDomain, clock: SimClock, topic: str, type_name: str, qos: Qos
    ) -> None:
        self.fault: Fault = healthy
        self.guid = b""
        self.failed = 0
        self.last_error = ""
        self.sent: list[bytes] = []
        """The newest message that the main compute wrote."""
        self._clock = clock
        self._new = partial(domain.publisher, topic, type_name, qos)
        self._writer: MemoryPublisher | None = None
        self._others: list[MemoryPublisher] = []
        self.restart()

    def write(self, data: bytes) -> bool:
        """Write one message; what arrives of it is up to the fault, and to the living writer."""
        self.sent[:] = [data]
        for after_s, changed in self.fault(data):
            if after_s <= 0.0:
                self._deliver(changed)
            else:
                at_ns = self._clock.monotonic_ns() + round(after_s * 1e9)
                self._clock.call_at(at_ns, partial(self._deliver, changed))
        return True

    def withdraw(self) -> None:
        """Take back what it said last."""
        if self._writer is not None:
            self._writer.withdraw()

    def _deliver(self, data: bytes) -> None:
        if self._writer is not None:
            self._writer.write(data)

    def stop(self) -> None:
        """Let the writer die: it is gone from the domain, and nothing arrives any more."""
        if self._writer is not None:
            self._writer.close()
        self._writer = None

    def restart(self) -> None:
        """Begin anew with a writer of another identity."""
        self.stop()
        self._writer = self._new()
        self.guid = self._writer.guid

    def intrude(self) -> MemoryPublisher:
        """Return a second writer on the topic."""
        self._others.append(self._new())
        return self._others[-1]

    def release(self, messages: Sequence[bytes]) -> None:
        """Deliver messages that were held back, in their order."""
        for data in messages:
            self._deliver(data)
