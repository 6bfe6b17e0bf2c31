# SPDX-License-Identifier: Apache-2.0
"""What a node needs of its topics: DDS offers it on a machine, plain memory in virtual time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from safety_island.dds.config import DdsConfig
from safety_island.dds.qos import Qos
from safety_island.dds.sample import Sample
from safety_island.node.memory import MemoryDomain
from safety_island.platform.interfaces import Platform


class Publisher(Protocol):
    """Where serialized messages of one topic go out; ``guid`` is its identity."""

    guid: bytes
    failed: int
    last_error: str

    def write(self, data: bytes) -> bool:
        """Send one message; False (counted and told) when it could not be handed over."""

    def withdraw(self) -> None:
        """Take back the last message: whoever subscribes later does not receive it."""


class Subscription(Protocol):
    """Where the messages of one topic are taken."""

    received: int
    superseded: int
    invalid: int

    @property
    def kept_out(self) -> int:
        """Messages of other publishers than the one that is kept to."""

    def keep_to(self, guid: bytes) -> bool:
        """Receive from this publisher alone, whatever others publish; empty: from all.

        False when it is not known (it has published nothing yet): then from all.
        """

    def renew(self) -> None:
        """Receive again what living publishers keep for late subscriptions."""

    def take_newest(self) -> Sample | None:
        """Return the newest message since the last call, None when there is none; drop others."""

    def take_all(self) -> Sequence[Sample]:
        """Return the messages since the last call in the order of their arrival."""


class Transport(Protocol):
    """One participant: makes publishers and subscriptions by ROS topic and type name."""

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """Make a publisher."""

    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription:
        """Make a subscription."""

    needs_discovery: bool
    """Whether it takes time to find the others in the domain."""

    def endpoint_changes(self) -> int:
        """Count the publishers and subscriptions of others that came or went so far."""

    def writers(self, topic: str, type_name: str) -> frozenset[bytes]:
        """Return the publishers of others on a topic that are alive, by their GUIDs.

        A transport that is shared by several nodes counts all of them.
        """

    def mismatches(self) -> Sequence[str]:
        """Say, one line each that begins with the topic, which endpoints of others do not match.

        Their type is another one than ours, or their QoS offers less than is requested.
        """

    def close(self) -> None:
        """Leave the domain."""


def open_transport(
    platform: Platform, domain_id: int, config: DdsConfig | None, node_name: str
) -> Transport:
    """Return the transport of a platform: memory for ``sim``, else DDS.

    Raises ConfigurationError or DdsError when the domain cannot be entered.
    """
    if platform.name == "sim":
        return MemoryDomain(platform.clock)
    from safety_island.dds.participant import Participant

    return Participant(domain_id, config, node_name)
