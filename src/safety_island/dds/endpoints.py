# SPDX-License-Identifier: Apache-2.0
"""Publisher and subscription: serialized samples in and out, newest first served, all counted."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from safety_island.dds import raw_topic
from safety_island.dds.library.builtin import matched_writer
from safety_island.dds.library.entity import checked, delete, guid_of, strerror
from safety_island.dds.library.layouts import ANY_INSTANCE, ANY_VIEW, NOT_READ
from safety_island.dds.library.loading import loaded
from safety_island.dds.library.policies import endpoint_policies
from safety_island.dds.names import ros_topic_name
from safety_island.dds.qos import Qos
from safety_island.dds.raw_topic import RawSample, RawTopic
from safety_island.dds.sample import Sample
from safety_island.dds.types import type_hash_data
from safety_island.dds.writer_filter import WriterFilter

_UNREAD = ANY_VIEW | ANY_INSTANCE | NOT_READ
_BATCH = 1024
UNKNOWN_WRITER = bytes(16)
"""Stands for a writer that was gone before its sample was taken."""


class Publisher:
    """Writes serialized messages to one topic; ``sent`` and ``failed`` count what became of it."""

    def __init__(
        self,
        participant: int,
        topic: RawTopic,
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
        self.entity = _writer(participant, topic, type_name, qos)
        self._on_close = on_close
        self.guid = guid_of(self.entity)

    def write(self, data: bytes) -> bool:
        """Send serialized CDR, header included; True when the library took it.

        Never raises and never waits longer than ``qos.MAX_BLOCKING_NS``; a refusal (no CDR of this
        type, or no room in time) is counted and told in ``last_error``.
        """
        code = raw_topic.write(self.entity, data)
        if code < 0:
            self.failed += 1
            self.last_error = strerror(code)
            return False
        self.sent += 1
        return True

    def withdraw(self) -> None:
        """Take back the last message: whoever subscribes later does not receive it.

        Subscriptions that had it receive a notice without data.
        """
        code = raw_topic.dispose(self.entity)
        if code < 0:
            self.failed += 1
            self.last_error = strerror(code)

    def matched(self) -> int:
        """Return how many subscriptions receive from this publisher now."""
        count: int = loaded().dds_get_matched_subscriptions(self.entity, None, 0)
        return max(count, 0)

    def close(self) -> None:
        """Leave the topic; the publisher must not be used afterwards."""
        self._on_close(self)
        delete(self.entity)


class Subscription:
    """Receives serialized messages of one topic.

    Counters: ``received`` samples taken, ``superseded`` those dropped for a newer one, ``invalid``
    notices without data (a writer or an instance went away). ``topic`` is its own: it may be
    filtered. ``on_change`` is called when its reader is another one, ``on_close`` when it ends.
    """

    def __init__(
        self,
        participant: int,
        topic: RawTopic,
        type_name: str,
        qos: Qos,
        on_close: Callable[[Subscription], None],
        ignore_own: bool = False,
        on_change: Callable[[Subscription, int], None] | None = None,
    ) -> None:
        self.topic = ros_topic_name(topic.name)
        self.type_name = type_name
        self.qos = qos
        self.received = 0
        self.superseded = 0
        self.invalid = 0
        self._filter = WriterFilter(topic.entity)
        self._topic = topic
        self._room = raw_topic.Room()
        self._new_reader = partial(_reader, participant, topic, type_name, qos, ignore_own)
        self._on_close, self._on_change = on_close, on_change
        self._open()

    def _open(self) -> None:
        self.entity = self._new_reader()
        self._writers: dict[int, bytes] = {}
        condition = loaded().dds_create_readcondition(self.entity, _UNREAD)
        self.condition = checked(condition, f"no condition for {self.topic}")
        self.guid = guid_of(self.entity)

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
        alive = [handle for handle in known if matched_writer(self.entity, handle) == guid]
        self._filter.state.writer = alive[-1] if alive else 0
        return bool(alive) or not guid

    def renew(self) -> None:
        """Receive again what living writers keep for late subscriptions, by another reader."""
        reader, condition = self.entity, self.condition
        self._open()
        if self._on_change is not None:
            self._on_change(self, condition)
        delete(condition)
        delete(reader)

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

    def take_raw(self) -> list[RawSample]:
        """Return all samples and notices since the last call, oldest first."""
        taken: list[RawSample] = []
        while len(batch := raw_topic.take(self.entity, _BATCH, self._room)) == _BATCH:
            taken += batch
        return taken + batch

    def matched(self) -> int:
        """Return how many publishers this subscription receives from now."""
        count: int = loaded().dds_get_matched_publications(self.entity, None, 0)
        return max(count, 0)

    def close(self) -> None:
        """Leave the topic; the subscription must not be used afterwards."""
        self._on_close(self)
        for entity in (self.condition, self.entity, self._topic.entity):
            delete(entity)

    def _take(self) -> list[RawSample]:
        samples: list[RawSample] = []
        taken = raw_topic.take(self.entity, _BATCH, self._room)
        samples += [raw for raw in taken if raw.valid]
        self.invalid += len(taken) - len(samples)
        self.received += len(samples)
        return samples

    def _sample(self, raw: RawSample) -> Sample:
        guid = self._writers.get(raw.publication_handle) or self._find(raw.publication_handle)
        return Sample(raw.data, raw.source_timestamp_ns, guid)

    def _find(self, handle: int) -> bytes:
        guid = matched_writer(self.entity, handle)
        if guid is None:
            return UNKNOWN_WRITER
        if len(self._writers) >= _BATCH:
            self._writers.clear()
        self._writers[handle] = guid
        return guid


def _writer(participant: int, topic: RawTopic, type_name: str, qos: Qos) -> int:
    with endpoint_policies(qos, type_hash_data(type_name), writer=True) as wanted:
        made = loaded().dds_create_writer(participant, topic.entity, wanted, None)
    return checked(made, f"a publisher on {topic.name} was refused")


def _reader(participant: int, topic: RawTopic, type_name: str, qos: Qos, ignore_own: bool) -> int:
    user_data = type_hash_data(type_name)
    with endpoint_policies(qos, user_data, writer=False, ignore_own=ignore_own) as wanted:
        made = loaded().dds_create_reader(participant, topic.entity, wanted, None)
    return checked(made, f"a subscription on {topic.name} was refused")
