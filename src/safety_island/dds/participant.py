# SPDX-License-Identifier: Apache-2.0
"""One participant in a DDS domain, seen by ROS 2 as one node."""

from __future__ import annotations

from dataclasses import replace
from types import TracebackType

from safety_island.dds.config import DdsConfig
from safety_island.dds.discovery import Endpoints, RemoteEndpoint
from safety_island.dds.domain import close_domain, closed_to_other_interfaces, open_domain
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.errors import DdsError
from safety_island.dds.library.entity import checked, delete, guid_of
from safety_island.dds.library.layouts import PUBLICATIONS, SUBSCRIPTIONS
from safety_island.dds.library.loading import loaded
from safety_island.dds.library.policies import policies
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
        self._nodes: Subscription | None = None
        self._node_names: dict[bytes, dict[bytes, str]] = {}
        """Node names by publisher, by participant."""
        self._closed = False
        open_domain(domain_id, config or DdsConfig())
        try:
            self.handle = _participant(domain_id)
            self._open()
        except DdsError:
            close_domain(domain_id)
            raise

    def _open(self) -> None:
        """Find the others and show itself; what fails leaves no participant behind."""
        try:
            self.guid = guid_of(self.handle)
            made = loaded().dds_create_waitset(self.handle)
            self._waitset = checked(made, "no wait set could be made")
            kinds = (PUBLICATIONS, SUBSCRIPTIONS)
            self._found = {kind: Endpoints(self.handle, kind) for kind in kinds}
            self._presence = self._publisher(PRESENCE_TOPIC, PRESENCE_TYPE, PRESENCE_QOS)
            self._found[PUBLICATIONS].check_layouts(self._presence.entity)
        except DdsError:
            delete(self.handle)
            raise
        self._announce()

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
            self.handle, own, type_name, qos, self._forget, ignore_own, self._replace
        )
        self._wait_for(subscription)
        self._subscriptions.append(subscription)
        self._announce()
        return subscription

    def wait(self, timeout_s: float) -> bool:
        """Wait until a subscription has something to take; False after ``timeout_s`` [s].

        Other Python threads run meanwhile.
        """
        timeout_ns = round(timeout_s * 1e9)
        count = loaded().dds_waitset_wait(self._waitset, None, 0, timeout_ns)
        return checked(count, "waiting for samples failed") > 0

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
                self.handle, found, PRESENCE_TYPE, qos, lambda _: None, ignore_own=True
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
        delete(self._waitset)
        delete(self.handle)
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
        return Publisher(self.handle, found, type_name, qos, self._forget)

    def _topic(self, dds_topic: str, type_name: str) -> RawTopic:
        key = (dds_topic, type_name)
        if key not in self._topics:
            self._topics[key] = self._own_topic(dds_topic, type_name)
        return self._topics[key]

    def _own_topic(self, dds_topic: str, type_name: str) -> RawTopic:
        """Return a topic entity that is shared with nothing else, so that it may be filtered."""
        return RawTopic(self.handle, dds_topic, type_name)

    def _wait_for(self, subscription: Subscription) -> None:
        condition = subscription.condition
        code = loaded().dds_waitset_attach(self._waitset, condition, condition)
        checked(code, f"{subscription.topic} cannot be waited for")

    def _replace(self, subscription: Subscription, condition: int) -> None:
        """Wait for the new reader of a subscription in place of its old one."""
        loaded().dds_waitset_detach(self._waitset, condition)
        self._wait_for(subscription)
        self._announce()

    def _forget(self, endpoint: Publisher | Subscription) -> None:
        if isinstance(endpoint, Subscription):
            loaded().dds_waitset_detach(self._waitset, endpoint.condition)
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


def _participant(domain_id: int) -> int:
    """Make a participant of an open domain, with no socket that other interfaces reach."""
    with policies(PARTICIPANT_USER_DATA) as qos, closed_to_other_interfaces(domain_id):
        made = loaded().dds_create_participant(domain_id, qos, None)
        return checked(made, f"no participant in domain {domain_id}")
