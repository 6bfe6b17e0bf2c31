# SPDX-License-Identifier: Apache-2.0
"""Topics in memory: the transport of the sim platform. The bytes are those of DDS."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from functools import partial

from safety_island.dds.names import dds_topic_name
from safety_island.dds.qos import INPUT_DEPTH, Qos
from safety_island.dds.sample import Sample
from safety_island.errors import ConfigurationError
from safety_island.messages.registry import lookup
from safety_island.platform.interfaces import Clock


class MemorySubscription:
    """Holds the newest messages until they are taken."""

    def __init__(self, latched: Sequence[MemoryPublisher] = ()) -> None:
        """``latched``: publishers that keep their last message for this subscription."""
        self.received = 0
        self.superseded = 0
        self.invalid = 0
        self.kept_out = 0
        """Messages of other publishers than the one that is kept to."""
        self._keeps_to = b""
        self._latched = latched
        self._waiting: deque[Sample] = deque(maxlen=INPUT_DEPTH)
        self.renew()

    def put(self, sample: Sample) -> None:
        """Receive a message."""
        if self._keeps_to and sample.writer_guid != self._keeps_to:
            self.kept_out += 1
            return
        self.received += 1
        self._waiting.append(sample)

    def keep_to(self, guid: bytes) -> bool:
        """Receive from this publisher alone; empty: from all."""
        self._keeps_to = guid
        return True

    def renew(self) -> None:
        """Receive again what living publishers keep for late subscriptions."""
        for writer in self._latched:
            if writer.last is not None:
                self.put(writer.last)

    def take_newest(self) -> Sample | None:
        """Return the newest message since the last call, None when there is none; drop others."""
        samples = self.take_all()
        if not samples:
            return None
        self.superseded += len(samples) - 1
        return samples[-1]

    def take_all(self) -> Sequence[Sample]:
        """Return the messages since the last call in the order of their arrival."""
        if not self._waiting:
            return ()
        samples = tuple(self._waiting)
        self._waiting.clear()
        return samples


class MemoryPublisher:
    """Hands its messages to every subscription of the topic, at once and without loss."""

    def __init__(
        self,
        clock: Clock,
        readers: list[MemorySubscription],
        guid: bytes,
        is_latched: bool,
        on_close: Callable[[MemoryPublisher], None],
    ) -> None:
        self.guid = guid
        self.failed = 0
        self.last_error = ""
        self.last: Sample | None = None
        """For those who subscribe later, where the topic is transient-local."""
        self._clock = clock
        self._readers = readers
        self._is_latched = is_latched
        self._on_close = on_close

    def close(self) -> None:
        """Leave the topic."""
        self._on_close(self)

    def write(self, data: bytes) -> bool:
        """Send one message; its time stamp is the virtual wall clock. Always possible."""
        if not self._readers and not self._is_latched:
            return True
        sample = tuple.__new__(Sample, (data, self._clock.wall_ns(), self.guid))
        for reader in self._readers:
            reader.put(sample)
        if self._is_latched:
            self.last = sample
        return True

    def withdraw(self) -> None:
        """Take back the last message: whoever subscribes later does not receive it."""
        self.last = None


class _Topic:
    def __init__(self, type_name: str) -> None:
        self.type_name = type_name
        self.readers: list[MemorySubscription] = []
        self.writers: frozenset[bytes] = frozenset()
        self.latched: list[MemoryPublisher] = []


class MemoryDomain:
    """The topics that a simulation shares; it is also the transport of every node in it.

    Not modelled: discovery time, loss, delay, reordering, fragmentation, QoS other than
    transient-local durability, and liveliness. (A fault campaign puts those between two topics.)
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._topics: dict[str, _Topic] = {}
        self._writers = 0
        self._changes = 0

    needs_discovery = False

    def publisher(self, topic: str, type_name: str, qos: Qos) -> MemoryPublisher:
        """Make a publisher; a transient-local one also serves subscriptions that come later."""
        found = self._topic(topic, type_name)
        self._writers += 1
        guid = self._writers.to_bytes(16, "big")
        is_latched = qos.durability == "transient_local"
        forget = partial(self._forget, found)
        writer = MemoryPublisher(self._clock, found.readers, guid, is_latched, forget)
        found.writers |= {guid}
        self._changes += 1
        if is_latched:
            found.latched.append(writer)
        return writer

    def subscription(self, topic: str, type_name: str, qos: Qos) -> MemorySubscription:
        """Make a subscription; a transient-local one starts with what was last said."""
        found = self._topic(topic, type_name)
        reader = MemorySubscription(found.latched if qos.durability == "transient_local" else ())
        found.readers.append(reader)
        return reader

    def endpoint_changes(self) -> int:
        """Count the publishers that came or went so far."""
        return self._changes

    def writers(self, topic: str, type_name: str) -> frozenset[bytes]:
        """Return the publishers on a topic, of every node in this domain."""
        return self._topics[topic].writers if topic in self._topics else frozenset()

    def mismatches(self) -> Sequence[str]:
        """Nothing: another type on a topic is an error of its publisher here."""
        return ()

    def _forget(self, found: _Topic, writer: MemoryPublisher) -> None:
        found.writers -= {writer.guid}
        if writer in found.latched:
            found.latched.remove(writer)
        self._changes += 1

    def close(self) -> None:
        """Memory needs no leaving; others may still use the domain."""

    def _topic(self, topic: str, type_name: str) -> _Topic:
        dds_topic_name(topic)
        found = self._topics.setdefault(topic, _Topic(lookup(type_name).name))
        if found.type_name != type_name:
            raise ConfigurationError(
                f"topic '{topic}' has the type {found.type_name} in this simulation, not "
                f"{type_name}: name the type that its other users have"
            )
        return found
