# SPDX-License-Identifier: Apache-2.0
"""Listens on a domain and keeps everything that comes, with the time at which it came."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, NamedTuple

from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.qos import DEFAULT
from safety_island.dds.topics import TopicEntry
from safety_island.messages.inputs import decode_odometry, decode_operation_mode
from safety_island.messages.outputs import decode_control
from safety_island.messages.status import decode_status

ROUND_S = 0.02
"""Longest wait at a time [s], so that whoever publishes meanwhile does so at 50 Hz."""

_DECODERS: dict[TopicEntry, Callable[[bytes], Any]] = {
    topics.STATUS: decode_status,
    topics.CONTROL: decode_control,
    topics.ODOMETRY: decode_odometry,
    topics.OPERATION_MODE: decode_operation_mode,
}


class Heard(NamedTuple):
    """One message."""

    message: Any
    writer: bytes
    at: float
    """When it was taken, on the monotonic clock [s]."""
    sent_ns: int
    """When it was written, by the writer's wall clock [ns]."""


def sent_since(commands: list[Heard], start_ns: int) -> list[int]:
    """Stamps [ns] of the commands that were written after a time of the wall clock [ns]."""
    return [one.message.stamp.nanoseconds for one in commands if one.sent_ns > start_ns]


class Ear:
    """A participant that listens on some topics; ``heard`` has all messages of each, in order."""

    def __init__(self, domain: int, *entries: TopicEntry) -> None:
        self.participant = Participant(domain, DdsConfig(interface="lo"), "ear")
        self.heard: dict[TopicEntry, list[Heard]] = {entry: [] for entry in entries}
        self._subscriptions = {
            entry: self.participant.subscription(
                # Commands as Autoware's gate hears them: nothing from before it listened.
                entry.name,
                entry.type_name,
                (DEFAULT if entry is topics.CONTROL else entry.qos).with_depth(64),
            )
            for entry in entries
        }

    def listen(self, timeout_s: float = ROUND_S) -> None:
        """Wait for something to come, and take it."""
        self.participant.wait(timeout_s)
        now = time.monotonic()
        for entry, subscription in self._subscriptions.items():
            for data, sent_ns, writer in subscription.take_all():
                message = _DECODERS[entry](data)
                self.heard[entry].append(Heard(message, writer, now, sent_ns))

    def close(self) -> None:
        """Leave the domain."""
        self.participant.close()
