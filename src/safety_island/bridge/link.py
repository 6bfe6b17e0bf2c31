"""One route at work: a subscription and a publisher, made when both ends are ready; counters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from safety_island.bridge.compression import COMPRESSED, CompressionError, compress, decompress
from safety_island.bridge.matching import match
from safety_island.bridge.routes import Route
from safety_island.dds.endpoints import UNKNOWN_WRITER, Publisher, Subscription
from safety_island.dds.participant import Participant
from safety_island.dds.qos import Qos
from safety_island.dds.wait_group import WaitGroup

Say = Callable[[str], None]
Transform = Callable[[bytes], bytes]
_TRANSFORMS: dict[str, Transform] = {"compress": compress, "decompress": decompress}
_MAX_TOLD = 32


@dataclass(frozen=True)
class WaitFor:
    """When a route is opened, and whether it is closed again when that no longer holds."""

    publisher: bool = True
    subscription: bool = False
    auto_remove: bool = False


@dataclass
class Counts:
    """What became of the samples of a route."""

    forwarded: int = 0
    bytes: int = 0
    own: int = 0
    """Came from this route's other direction and were dropped."""
    refused: int = 0
    """Could not be compressed or restored."""
    failed: int = 0
    """Were not taken by the publisher."""


@dataclass
class _Ends:
    subscription: Subscription
    publisher: Publisher
    qos: Qos


@dataclass
class Link:
    """Forwards the samples of one route.

    ``mirror`` is the other direction of a bidirectional entry; ``feeders`` are the other links of
    this process that write what this one reads, ``feeds`` those that read what this one writes.
    """

    route: Route
    source: Participant
    target: Participant
    group: WaitGroup[Link]
    wait_for: WaitFor
    say: Say
    mirror: Link | None = None
    feeders: list[Link] = field(default_factory=list)
    feeds: list[Link] = field(default_factory=list)
    counts: Counts = field(default_factory=Counts)

    def __post_init__(self) -> None:
        """Work out the types of both ends."""
        mode = self.route.mode
        self._ends: _Ends | None = None
        self._told: set[str] = set()
        self._written_as: set[bytes] = set()  # every identity of this link's publisher
        self._transform = _TRANSFORMS.get(mode)
        self.read_type = COMPRESSED if mode == "decompress" else self.route.type_name
        self.write_type = COMPRESSED if mode == "compress" else self.route.type_name

    @property
    def is_open(self) -> bool:
        """Whether samples are forwarded now."""
        return self._ends is not None

    def look(self) -> None:
        """Look at who is there; open, close, or change the QoS accordingly."""
        offers, warnings = self._offers()
        ready = self._is_ready(bool(offers))
        if self._ends is not None and not ready and self.wait_for.auto_remove:
            self.close()
            self.say(f"{self.route}: closed, an end that it waits for is gone")
        if (self._ends is None and ready) or (self._ends is not None and offers):
            found = match(self.route.qos, offers)
            if self._ends is None or self._ends.qos != found.qos:
                self._open(found.qos)
            warnings += found.warnings
        self._tell(warnings)

    def forward(self) -> int:
        """Forward everything that has come, oldest first; return how many samples went out."""
        ends = self._ends
        if ends is None:
            return 0
        sent = 0
        for sample in ends.subscription.take_all():
            if self._is_echo(sample.writer_guid):
                self.counts.own += 1
            elif self._send(ends.publisher, sample.data):
                sent += 1
        self.counts.forwarded += sent
        return sent

    def close(self) -> None:
        """Leave both topics."""
        if self._ends is not None:
            self.group.remove(self._ends.subscription)
            self._ends.subscription.close()
            self._ends.publisher.close()
            self._ends = None

    def _is_echo(self, writer: bytes) -> bool:
        """Whether a sample was written by this route's other direction.

        Without feeders the subscription is deaf to this process anyway.
        """
        if self.mirror is None or not self.feeders:
            return False
        return writer == UNKNOWN_WRITER or writer in self.mirror._written_as

    def _send(self, publisher: Publisher, data: bytes) -> bool:
        if self._transform is not None:
            try:
                data = self._transform(data)
            except CompressionError as problem:
                self.counts.refused += 1
                self._tell((f"sample refused: {problem}",))
                return False
        if not publisher.write(data):
            self.counts.failed += 1
            self._tell((f"sample lost in domain {self.route.target[0]}: {publisher.last_error}",))
            return False
        self.counts.bytes += len(data)
        return True

    def _offers(self) -> tuple[list[Qos], tuple[str, ...]]:
        """QoS of the publishers that this route can hear; a warning for those of another type."""
        found = self.source.publications(self.route.source[1])
        heard = [other.qos for other in found if other.type_name == self.read_type]
        heard += [link._ends.qos for link in self.feeders if link._ends is not None]
        other_types = {other.type_name for other in found} - {self.read_type}
        return heard, tuple(
            f"published as {name} in domain {self.route.source[0]}, the bridge file has "
            f"{self.read_type} ({self.route.where})"
            for name in sorted(other_types)
        )

    def _is_ready(self, has_publisher: bool) -> bool:
        if self.wait_for.publisher and not has_publisher:
            return False
        return not self.wait_for.subscription or self._is_wanted()

    def _is_wanted(self) -> bool:
        """Whether a subscription waits in the target domain, or beyond it over other routes."""
        others = self.target.subscriptions(self.route.target[1])
        if any(other.type_name == self.write_type for other in others):
            return True
        return any(link._is_wanted() for link in self.feeds)

    def _open(self, qos: Qos) -> None:
        changed = self._ends is not None
        self.close()
        publisher = self.target.publisher(self.route.target[1], self.write_type, qos)
        subscription = self.source.subscription(
            self.route.source[1], self.read_type, qos, ignore_own=not self.feeders
        )
        self.group.add(subscription, self)
        self._ends = _Ends(subscription, publisher, qos)
        self._written_as.add(publisher.guid)
        self._told.clear()
        word = "changed to" if changed else "open,"
        self.say(f"{self.route}: {word} {qos.reliability} {qos.durability}")

    def _tell(self, warnings: tuple[str, ...]) -> None:
        """Say each warning once; all anew when the route was opened again."""
        for warning in warnings:
            if warning not in self._told and len(self._told) < _MAX_TOLD:
                self._told.add(warning)
                self.say(f"{self.route}: {warning}")
