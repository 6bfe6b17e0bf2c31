# SPDX-License-Identifier: Apache-2.0
"""One participant in a DDS domain, seen by ROS 2 as one node."""

from __future__ import annotations

from dataclasses import replace
from types import TracebackType

from cyclonedds.core import DDSException, ReadCondition, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.qos import Policy
from cyclonedds.qos import Qos as CycloneQos

from safety_island.dds import binding
from safety_island.dds.config import DdsConfig
from safety_island.dds.discovery import PUBLICATIONS, SUBSCRIPTIONS, Endpoints, RemoteEndpoint
from safety_island.dds.domain import close_domain, closed_to_other_interfaces, open_domain
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.errors import DdsError
from safety_island.dds.mismatch import why_not
from safety_island.dds.names import dds_topic_name
from safety_island.dds.presence import (
    PARTICIPANT_USER_DATA,
    check_node_name,
    nodes_of_writers,
    presence,
)
from safety_island.dds.presence import QOS as PRESENCE_QOS
from safety_island.dds.presence import TOPIC as PRESENCE_TOPIC
from safety_island.dds.presence import TYPE as PRESENCE_TYPE
from safety_island.dds.qos import DEFAULT, Qos
from safety_island.dds.raw_topic import RawTopic
from safety_island.messages.errors import DecodeError

DEFAULT_NODE_NAME = "safety_island"


class Participant:
    """A participant with its publishers and subscriptions; a context manager that closes them.

    Several may live in one process, on different domains or on the same one. Raises
    ConfigurationError when the domain id, the configuration or a name cannot be used.
    """

    def __init__(
        self,
        domain_id: int,
        config: DdsConfig | None = None,
        node_name: str = DEFAULT_NODE_NAME,
        namespace: str = "/",
    ) -> None:
        check_node_name(node_name, namespace)
        self.domain_id = domain_id
        self._name = (namespace, node_name)
        self._topics: dict[tuple[str, str], RawTopic] = {}
        self._publishers: list[Publisher] = []
        self._subscriptions: list[Subscription] = []
        open_domain(domain_id, config or DdsConfig())
        self._closed = False
        try:
            qos = CycloneQos(Policy.Userdata(PARTICIPANT_USER_DATA))
            with closed_to_other_interfaces(domain_id):
                self._participant = DomainParticipant(domain_id, qos)
        except DDSException as problem:
            close_domain(domain_id)
            raise DdsError(f"no participant in domain {domain_id}: {problem}") from None
        except DdsError:
            close_domain(domain_id)
            raise
        self.guid: bytes = self._participant.guid.bytes
        self._waitset = WaitSet(self._participant)
        self._found = {
            kind: Endpoints(self._participant, kind) for kind in (PUBLICATIONS, SUBSCRIPTIONS)
        }
        self._presence = self._publisher(PRESENCE_TOPIC, PRESENCE_TYPE, PRESENCE_QOS)
        self._nodes: Subscription | None = None
        self._node_names: dict[bytes, dict[bytes, str]] = {}
        """Node names by publisher, by participant."""
        self._announce()

    @property
    def handle(self) -> int:
        """The library's number of this participant, for its C functions."""
        handle: int = self._participant._ref
        return handle

    def publisher(self, topic: str, type_name: str, qos: Qos = DEFAULT) -> Publisher:
        """Return a new publisher on a ROS topic (``/a/b``) of a ROS type (``pkg/msg/Name``)."""
        publisher = self._publisher(dds_topic_name(topic), type_name, qos)
        self._publishers.append(publisher)
        self._announce()
        return publisher

    def subscription(
        self, topic: str, type_name: str, qos: Qos = DEFAULT, *, ignore_own: bool = False
    ) -> Subscription:
        """Return a new subscription; with ``ignore_own`` it is deaf to this participant."""
        own = self._own_topic(dds_topic_name(topic), type_name)
        subscription = Subscription(
            self._participant, own, type_name, qos, self._forget, ignore_own, self._replace
        )
        self._waitset.attach(subscription.condition)
        self._subscriptions.append(subscription)
        self._announce()
        return subscription

    def wait(self, timeout_s: float) -> bool:
        """Wait until a subscription has something to take; False after ``timeout_s`` [s].

        Other Python threads run meanwhile.
        """
        return self._waitset.wait(round(timeout_s * 1e9)) > 0

    def publications(self, topic: str) -> list[RemoteEndpoint]:
        """Return the publishers of other participants on a ROS topic, whatever their type."""
        return self._found[PUBLICATIONS].on(topic)

    def publication(self, handle: int) -> RemoteEndpoint | None:
        """Return the publisher of a sample's ``publication_handle``, also when it has left."""
        return self._found[PUBLICATIONS].by_handle(handle)

    def subscriptions(self, topic: str) -> list[RemoteEndpoint]:
        """Return the subscriptions of other participants on a ROS topic, whatever their type."""
        return self._found[SUBSCRIPTIONS].on(topic)

    def node_of(self, endpoint: RemoteEndpoint) -> str:
        """Return the full name of a publisher's ROS 2 node; empty when it is not known.

        Anybody on the domain may call itself so.
        """
        if self._nodes is None:
            found = self._topic(PRESENCE_TOPIC, PRESENCE_TYPE)
            qos = replace(PRESENCE_QOS, history="keep_all")
            self._nodes = Subscription(
                self._participant, found, PRESENCE_TYPE, qos, lambda _: None, ignore_own=True
            )
        for sample in self._nodes.take_all():
            try:
                participant, nodes = nodes_of_writers(sample.data)
            except DecodeError:
                continue
            self._node_names[participant] = nodes
        names = (nodes.get(endpoint.guid) for nodes in self._node_names.values())
        return next((name for name in names if name), "")

    needs_discovery = True
    """It takes some time to find the others in a domain."""

    def endpoint_changes(self) -> int:
        """Count the publishers of others that came, changed or went so far; cheap to ask."""
        return self._found[PUBLICATIONS].changes()

    def changes(self) -> int:
        """Count the publishers and subscriptions of others that came, changed or went so far."""
        return sum(found.changes() for found in self._found.values())

    def writers(self, topic: str, type_name: str) -> frozenset[bytes]:
        """Return the live publishers of other participants on a ROS topic, by their GUIDs."""
        found = self.publications(topic)
        return frozenset(endpoint.guid for endpoint in found if endpoint.type_name == type_name)

    def mismatches(self) -> list[str]:
        """Say, one line each, which remote endpoints on our topics do not match and why."""
        found = []
        for subscription in self._subscriptions:
            for remote in self.publications(subscription.topic):
                found.append(
                    why_not(remote, subscription.type_name, subscription.qos, publisher=True)
                )
        for publisher in self._publishers:
            for remote in self.subscriptions(publisher.topic):
                found.append(why_not(remote, publisher.type_name, publisher.qos, publisher=False))
        return [line for line in found if line]

    def close(self) -> None:
        """Leave the domain at once; others are told. A second call does nothing."""
        if self._closed:
            return
        self._closed = True
        endpoints: list[Publisher | Subscription] = [*self._publishers, *self._subscriptions]
        if self._nodes is not None:
            endpoints.append(self._nodes)
        for endpoint in (*endpoints, self._presence):
            endpoint.close()
        for kind in self._found.values():
            kind.close()
        binding.delete(self._waitset)
        binding.delete(self._participant)
        close_domain(self.domain_id)

    def __enter__(self) -> Participant:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _publisher(self, dds_topic: str, type_name: str, qos: Qos) -> Publisher:
        found = self._topic(dds_topic, type_name)
        return Publisher(self._participant, found, type_name, qos, self._forget)

    def _topic(self, dds_topic: str, type_name: str) -> RawTopic:
        key = (dds_topic, type_name)
        if key not in self._topics:
            self._topics[key] = self._own_topic(dds_topic, type_name)
        return self._topics[key]

    def _own_topic(self, dds_topic: str, type_name: str) -> RawTopic:
        """Return a topic entity that is shared with nothing else, so that it may be filtered."""
        try:
            return RawTopic(self._participant, dds_topic, type_name)
        except DDSException as problem:
            raise DdsError(f"topic {dds_topic} of {type_name}: {problem}") from None

    def _replace(self, subscription: Subscription, condition: ReadCondition) -> None:
        """Wait for the new reader of a subscription in place of its old one."""
        self._waitset.detach(condition)
        self._waitset.attach(subscription.condition)
        self._announce()

    def _forget(self, endpoint: Publisher | Subscription) -> None:
        if isinstance(endpoint, Subscription):
            self._waitset.detach(endpoint.condition)
        if self._closed:
            return
        if isinstance(endpoint, Subscription):
            self._subscriptions.remove(endpoint)
        else:
            self._publishers.remove(endpoint)
        self._announce()

    def _announce(self) -> None:
        readers = [subscription.guid for subscription in self._subscriptions]
        writers = [publisher.guid for publisher in self._publishers]
        self._presence.write(presence(self.guid, *self._name, readers, writers))
