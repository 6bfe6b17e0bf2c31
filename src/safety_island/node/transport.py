"""What a node needs of its topics: DDS offers it on a machine, plain memory in virtual time."""

from __future__ import annotations

from typing import Protocol

from safety_island.dds.config import DdsConfig
from safety_island.dds.qos import Qos
from safety_island.node.memory import MemoryDomain
from safety_island.platform.interfaces import Platform


class Sample(Protocol):
    """One received message."""

    @property
    def data(self) -> bytes:
        """Serialized message, encapsulation header included."""

    @property
    def source_timestamp_ns(self) -> int:
        """When it was written, by the writer's own clock [ns]."""

    @property
    def writer_guid(self) -> bytes:
        """Identity of the writer."""


class Publisher(Protocol):
    """Where serialized messages of one topic go out."""

    failed: int
    last_error: str

    def write(self, data: bytes) -> bool:
        """Send one message; False (counted and told) when it could not be handed over."""


class Subscription(Protocol):
    """Where the newest message of one topic is taken; older ones are dropped and counted."""

    received: int
    superseded: int
    invalid: int

    def take_newest(self) -> Sample | None:
        """Return the newest message since the last call; None when there is none."""


class Transport(Protocol):
    """One participant: makes publishers and subscriptions by ROS topic and type name."""

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """Make a publisher."""

    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription:
        """Make a subscription."""

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
