# SPDX-License-Identifier: Apache-2.0
"""Who else is in the domain: endpoints of other participants, as DDS discovery tells them."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from safety_island.dds.library.builtin import BATCH, BuiltinReader, RawEndpoint
from safety_island.dds.library.entity import delete, guid_of
from safety_island.dds.names import ros_topic_name
from safety_island.dds.qos import Qos
from safety_island.messages.registry import ros_type_name


@dataclass(frozen=True)
class RemoteEndpoint:
    """A publisher or subscription of another participant.

    ``guid`` and ``participant`` are 16 bytes; ``topic`` and ``type_name`` are ROS names where they
    follow ROS, else DDS names; ``type_hash`` is empty when it was not announced.
    """

    guid: bytes
    participant: bytes
    topic: str
    type_name: str
    qos: Qos
    type_hash: str = ""
    handle: int = 0
    """The ``publication_handle`` of its samples."""
    number: int = 0
    """How many endpoints were found before: one that left and came back has another number."""
    lives: int = 0
    """How often it had left before, as far as the library remembers."""


class Endpoints:
    """The endpoints of one kind (publications or subscriptions) that are alive now."""

    def __init__(self, participant: int, kind: int) -> None:
        self._own = guid_of(participant)
        self._participant = participant
        self._reader = BuiltinReader(participant, kind)
        self._known: dict[bytes, RemoteEndpoint] = {}
        self._found = 0
        self._gone: deque[RemoteEndpoint] = deque(maxlen=BATCH)
        self._changes = 0

    def on(self, topic: str) -> list[RemoteEndpoint]:
        """Return the live endpoints on a ROS topic, oldest first."""
        self._refresh()
        return [endpoint for endpoint in self._known.values() if endpoint.topic == topic]

    def by_handle(self, handle: int) -> RemoteEndpoint | None:
        """Return the endpoint of a handle, also one of those that left last."""
        self._refresh()
        known = (*self._known.values(), *reversed(self._gone))
        return next((endpoint for endpoint in known if endpoint.handle == handle), None)

    def changes(self) -> int:
        """Count what came, changed or went so far."""
        self._refresh()
        return self._changes

    def check_layouts(self, endpoint: int) -> None:
        """Raise DdsError unless the library describes this own endpoint as is expected."""
        self._reader.check_layouts(self._participant, endpoint)

    def close(self) -> None:
        """Stop listening to discovery."""
        delete(self._reader.entity)

    def _refresh(self) -> None:
        while True:
            events = self._reader.take()
            self._changes += len(events)
            for event in events:
                self._note(event)
            if len(events) < BATCH:
                return

    def _note(self, event: RawEndpoint) -> None:
        known = self._known.get(event.guid)
        if known is not None and not (event.alive and event.lives == known.lives):
            self._gone.append(self._known.pop(event.guid))
            known = None
        elif known is None and not event.alive and event.topic:  # it left before anybody looked
            self._found += 1
            self._gone.append(_endpoint(event, self._found))
        if event.alive and event.participant != self._own:
            self._found += known is None
            number = self._found if known is None else known.number
            self._known[event.guid] = _endpoint(event, number)


def _endpoint(event: RawEndpoint, number: int) -> RemoteEndpoint:
    return RemoteEndpoint(
        guid=event.guid,
        participant=event.participant,
        topic=ros_topic_name(event.topic),
        type_name=ros_type_name(event.type_name),
        qos=event.qos,
        type_hash=_type_hash(event.user_data),
        handle=event.handle,
        number=number,
        lives=event.lives,
    )


def _type_hash(user_data: bytes) -> str:
    for item in user_data.decode("latin-1").split(";"):
        name, _, value = item.partition("=")
        if name == "typehash":
            return value
    return ""
