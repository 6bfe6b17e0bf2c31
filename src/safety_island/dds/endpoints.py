# SPDX-License-Identifier: Apache-2.0
"""Publisher and subscription: serialized samples in and out, newest first served, all counted."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from cyclonedds.core import DDSException, InstanceState, ReadCondition, SampleState, ViewState
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

from safety_island.dds import binding, raw_topic
from safety_island.dds.errors import DdsError
from safety_island.dds.names import ros_topic_name
from safety_island.dds.qos import Qos, cyclone_qos
from safety_island.dds.sample import Sample
from safety_island.dds.types import type_hash_data
from safety_island.dds.writer_filter import WriterFilter

_UNREAD = ViewState.Any | InstanceState.Any | SampleState.NotRead
_BATCH = 1024
UNKNOWN_WRITER = bytes(16)
"""Stands for a writer that was gone before its sample was taken."""


class Publisher:
    """Writes serialized messages to one topic; ``sent`` and ``failed`` count what became of it."""

    def __init__(
        self,
        participant: DomainParticipant,
        topic: Topic[Any],
        type_name: str,
        qos: Qos,
        on_close: Callable[[Publisher], None],
    ) -> None:
        self.topic = ros_topic_name(topic.name)
        self.type_name = type_name
        self.qos = qos
        self.sent = 0
        self.failed = 0
        self.last_error = ""
        wanted = cyclone_qos(qos, type_hash_data(type_name), writer=True)
        self._writer: DataWriter[Any] = _create(DataWriter, participant, topic, wanted)
        self._ref: int = self._writer._ref
        self._on_close = on_close
        self.guid: bytes = self._writer.guid.bytes

    def write(self, data: bytes) -> bool:
        """Send serialized CDR, header included; True when the library took it.

        Never raises and never waits longer than ``qos.MAX_BLOCKING_NS``; a refusal (no CDR of this
        type, or no room in time) is counted and told in ``last_error``.
        """
        code = raw_topic.write(self._ref, data)
        if code < 0:
            self.failed += 1
            self.last_error = binding.strerror(code)
            return False
        self.sent += 1
        return True

    def withdraw(self) -> None:
        """Take back the last message: whoever subscribes later does not receive it.

        Subscriptions that had it receive a notice without data.
        """
        code = raw_topic.dispose(self._ref)
        if code < 0:
            self.failed += 1
            self.last_error = binding.strerror(code)

    def matched(self) -> int:
        """Return how many subscriptions receive from this publisher now."""
        return len(self._writer.get_matched_subscriptions())

    def close(self) -> None:
        """Leave the topic; the publisher must not be used afterwards."""
        self._on_close(self)
        binding.delete(self._writer)


class Subscription:
    """Receives serialized messages of one topic.

    Counters: ``received`` samples taken, ``superseded`` those dropped for a newer one, ``invalid``
    notices without data (a writer or an instance went away). ``topic`` is its own: it may be
    filtered. ``on_change`` is called when its reader is another one, ``on_close`` when it ends.
    """

    def __init__(
        self,
        participant: DomainParticipant,
        topic: Topic[Any],
        type_name: str,
        qos: Qos,
        on_close: Callable[[Subscription], None],
        ignore_own: bool = False,
        on_change: Callable[[Subscription, ReadCondition], None] | None = None,
    ) -> None:
        self.topic = ros_topic_name(topic.name)
        self.type_name = type_name
        self.qos = qos
        self.received = 0
        self.superseded = 0
        self.invalid = 0
        wanted = cyclone_qos(qos, type_hash_data(type_name), writer=False, ignore_own=ignore_own)
        self._filter = WriterFilter(topic._ref)
        self._topic = topic
        self._room = raw_topic.Room()
        self._new_reader = partial(_create, DataReader, participant, topic, wanted)
        self._on_close, self._on_change = on_close, on_change
        self._open()

    def _open(self) -> None:
        self._reader: DataReader[Any] = self._new_reader()
        self._ref: int = self._reader._ref
        self._writers: dict[int, bytes] = {}
        self.condition = ReadCondition(self._reader, _UNREAD)
        self.guid: bytes = self._reader.guid.bytes

    @property
    def kept_out(self) -> int:
        """Samples of other writers than the one that is kept to."""
        count: int = self._filter.state.kept_out
        return count

    def keep_to(self, guid: bytes) -> bool:
        """Receive from this writer alone, whatever others write; empty: from all.

        False when it is not matched, or has written nothing yet: then from all.
        """
        known = [handle for handle, writer in self._writers.items() if writer == guid]
        alive = [handle for handle in known if binding.matched_writer(self._ref, handle) == guid]
        self._filter.state.writer = alive[-1] if alive else 0
        return bool(alive) or not guid

    def renew(self) -> None:
        """Receive again what living writers keep for late subscriptions, by another reader."""
        reader, condition = self._reader, self.condition
        self._open()
        if self._on_change is not None:
            self._on_change(self, condition)
        binding.delete(condition)
        binding.delete(reader)

    def take_newest(self) -> Sample | None:
        """Return the newest sample since the last call and drop the older ones; None when none."""
        samples = self._take()
        if not samples:
            return None
        self.superseded += len(samples) - 1
        return self._sample(samples[-1])

    def take_all(self) -> list[Sample]:
        """Return all samples since the last call, oldest first."""
        return [self._sample(raw) for raw in self._take()]

    def take_raw(self) -> list[binding.RawSample]:
        """Return all samples and notices since the last call, oldest first."""
        taken: list[binding.RawSample] = []
        while len(batch := raw_topic.take(self._ref, _BATCH, self._room)) == _BATCH:
            taken += batch
        return taken + batch

    def matched(self) -> int:
        """Return how many publishers this subscription receives from now."""
        return len(self._reader.get_matched_publications())

    def close(self) -> None:
        """Leave the topic; the subscription must not be used afterwards."""
        self._on_close(self)
        for entity in (self.condition, self._reader, self._topic):
            binding.delete(entity)

    def _take(self) -> list[binding.RawSample]:
        samples: list[binding.RawSample] = []
        taken = raw_topic.take(self._ref, _BATCH, self._room)
        samples += [raw for raw in taken if raw.valid]
        self.invalid += len(taken) - len(samples)
        self.received += len(samples)
        return samples

    def _sample(self, raw: binding.RawSample) -> Sample:
        guid = self._writers.get(raw.publication_handle) or self._find(raw.publication_handle)
        return Sample(raw.data, raw.source_timestamp_ns, guid)

    def _find(self, handle: int) -> bytes:
        guid = binding.matched_writer(self._ref, handle)
        if guid is None:
            return UNKNOWN_WRITER
        if len(self._writers) >= _BATCH:
            self._writers.clear()
        self._writers[handle] = guid
        return guid


def _create(kind: Any, participant: DomainParticipant, topic: Topic[Any], qos: Any) -> Any:
    try:
        return kind(participant, topic, qos)
    except DDSException as problem:
        raise DdsError(f"{kind.__name__} on {topic.name} was refused: {problem}") from None
