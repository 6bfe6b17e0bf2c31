# SPDX-License-Identifier: Apache-2.0
"""One route at work: its subscriptions, its publishers beyond, and who is on either end.

A subscription for each kind of publisher asks for what that kind offers, so nobody who joins makes
it listen more weakly to those who were there. Beyond, every latched publisher has a publisher of
its own, with its depth and its life; the others share one, which lives as long as one of them.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from safety_island.bridge.compression import COMPRESSED, CompressionError, compress, decompress
from safety_island.bridge.config_file import Keep
from safety_island.bridge.inlets import Inlets, Taken
from safety_island.bridge.kept import Kept, keep
from safety_island.bridge.matching import NO_OFFER, offer_beyond, request, unmet
from safety_island.bridge.outlet import HOLD_S, Counts, Outlet
from safety_island.bridge.outlets import Outlets
from safety_island.bridge.routes import Route
from safety_island.dds.discovery import RemoteEndpoint
from safety_island.dds.endpoints import Subscription
from safety_island.dds.mismatch import incompatible_policies
from safety_island.dds.participant import Participant
from safety_island.dds.qos import Qos
from safety_island.dds.raw_topic import RawSample
from safety_island.dds.wait_group import WaitGroup

Say = Callable[[str], None]
Alarm = Callable[[Mapping[str, Any]], None]
Transform = Callable[[bytes], bytes]
_TRANSFORMS: dict[str, Transform] = {"compress": compress, "decompress": decompress}
_MAX_TOLD = 32
ALARM_S = 1.0
"""Time [s] between two alarms of a route: publishers may come and go quickly."""


@dataclass(frozen=True)
class WaitFor:
    """When a route is opened, and whether it is closed again when that no longer holds."""

    publisher: bool = True
    subscription: bool = False
    auto_remove: bool = False


@dataclass
class _Source:
    """A publisher that is forwarded."""

    endpoint: RemoteEndpoint
    asked: Qos
    """What the subscription that hears it asks for."""
    outlet: Outlet | None = None
    has_sent: bool = False
    """Whether it has sent something and is held to be alive since."""
    is_quiet: bool = False
    """Whether it unregistered, or was found not alive, and has sent nothing since."""
    new_until: float = 0.0
    """Monotonic time [s] until which what comes may be its history."""
    is_between: bool = False
    """Whether its own subscription has just been opened, and another one was heard until then."""
    early: set[int] = field(default_factory=set)
    """Source times [ns] of what was forwarded from that other one."""


class Link:
    """Forwards the samples of one route."""

    def __init__(
        self,
        route: Route,
        source: Participant,
        target: Participant,
        group: WaitGroup[Link],
        wait_for: WaitFor,
        say: Say,
        alarm: Alarm,
    ) -> None:
        self.route = route
        self.counts = Counts()
        self.is_open = False
        """Whether it listens, and forwards what it receives."""
        self.read_type = COMPRESSED if route.mode == "decompress" else route.type_name
        self.write_type = COMPRESSED if route.mode == "compress" else route.type_name
        self._transform = _TRANSFORMS.get(route.mode)
        self._source, self._target, self._group = source, target, group
        self._wait_for, self._say, self._alarm = wait_for, say, alarm
        self._inlets = Inlets(self._subscribe, self._leave)
        self._outlets = Outlets(
            route.qos, target, (route.target[1], self.write_type), self.counts, self._lost
        )
        self._requests: dict[Qos, Qos] = {}
        self._sources: dict[int, _Source] = {}
        self._foreign: set[int] = set()
        """Handles of publishers on the topic that are not forwarded."""
        self._kept = Kept()
        self._found_at: float | None = None
        self._told: set[str] = set()
        self._alarmed: tuple[RemoteEndpoint, ...] = ()
        self._alarmed_at = -ALARM_S

    def look(self) -> None:
        """Look at who is there; open, close, or follow them."""
        now = time.monotonic()
        found = self._publishers()
        ready = self._is_ready(found, now)
        if ready and not self.is_open:
            self.is_open = True
            self._told.clear()
        elif not ready and self.is_open and self._wait_for.auto_remove:
            self.close()
            self._say(f"{self.route}: closed, an end that it waits for is gone")
        if self.is_open:
            self._process(now, self._inlets.take(), must_update=True)
            self._show_a_publisher(now)
        self._warn()

    def forward(self, *, stood_still: bool = False) -> None:
        """Forward everything that has come, oldest first.

        ``stood_still``: it may have come long ago. What was latched and has ended meanwhile is not
        passed on then: a command from before a silence would arrive after it.
        """
        if not self.is_open:
            return
        taken = self._inlets.take()
        if stood_still:
            taken = [(asked, _without_what_ended(asked, raw)) for asked, raw in taken]
        self._process(time.monotonic(), taken, must_update=stood_still)

    @property
    def is_holding(self) -> bool:
        """Whether a publisher beyond is so new that it holds its samples."""
        return self._outlets.is_holding(time.monotonic())

    @property
    def is_unsettled(self) -> bool:
        """Whether there is something to do at the next look, though nobody came or went."""
        return (
            self._outlets.are_unsettled
            or (self._found_at is not None and not self.is_open)
            or self._kept.others != self._alarmed
            or self.route.keep.publisher.startswith("/")  # nodes tell their names later
        )

    def close(self) -> None:
        """Leave both topics."""
        self._inlets.close()
        self._outlets.close()
        self._sources.clear()
        self._foreign.clear()
        self._kept, self._found_at, self.is_open = Kept(), None, False

    def _process(self, now: float, taken: Taken, *, must_update: bool) -> None:
        """Forward what was taken; what a publisher sent last comes before its end."""
        gone: list[_Source] = []
        must_update = must_update or not all(self._knows(raw) for _, raw in taken)
        if must_update:
            gone, more = self._update(now, {raw.publication_handle for _, raw in taken})
            taken += more + (self._inlets.take() if gone else [])
        self._outlets.flush(now)
        self._pass_on(now, taken)
        if not all(raw.is_alive for _, raw in taken):
            self._end(taken)
        if must_update:
            self._release(gone)
            self._outlets.tidy(now, keeps_one=not self._wait_for.publisher)

    def _knows(self, raw: RawSample) -> bool:
        return raw.publication_handle in self._sources or raw.publication_handle in self._foreign

    def _update(self, now: float, heard: set[int]) -> tuple[list[_Source], Taken]:
        """Follow who is there; return who is gone, and what came to older subscriptions.

        ``heard``: handles of publishers of which something has come; they may have left already.
        """
        found = self._publishers()
        before, self._kept = (
            self._kept,
            keep(self.route.keep, found, self._kept, self._source.node_of),
        )
        wanted = {one.handle: one for one in self._kept.forwarded if self._can_hear(one)}
        gone = [one for handle, one in self._sources.items() if wanted.get(handle) is None]
        if self._kept.forwarded != before.forwarded and self._foreign & wanted.keys():
            self._inlets.close()  # what it had latched was dropped, and has to come again
        for handle, endpoint in wanted.items():
            gone += self._follow(handle, endpoint, now)
        gone += self._follow_the_departed(heard - self._sources.keys() - {o.handle for o in found})
        self._foreign = {one.handle for one in found} - wanted.keys()
        asked = {source.asked for source in self._sources.values()}
        opened, more = self._inlets.open(asked or self._default_request())
        for source in self._sources.values():
            source.is_between = source.asked in opened
        return gone, more

    def _follow(self, handle: int, endpoint: RemoteEndpoint, now: float) -> list[_Source]:
        """Take a publisher in; return what it was, when it left and came back."""
        known = self._sources.get(handle)
        if known is not None and known.endpoint.number == endpoint.number:
            known.endpoint = endpoint
            return []
        self._sources[handle] = _Source(endpoint, self._request(endpoint), new_until=now + HOLD_S)
        return [] if known is None else [known]

    def _follow_the_departed(self, handles: set[int]) -> list[_Source]:
        """Take in publishers that left before anybody looked: what they sent is still to go."""
        found = []
        for handle in handles if self.route.keep == Keep() else ():
            endpoint = self._source.publication(handle)
            if endpoint is not None and self._can_hear(endpoint):
                source = _Source(endpoint, self._request(endpoint), is_between=True)
                self._sources[handle] = source
                found.append(source)
        return found

    def _request(self, endpoint: RemoteEndpoint) -> Qos:
        """What is asked for to hear a publisher; always the same object, so that ``is`` tells."""
        asked = request(self.route.qos, endpoint.qos)
        return self._requests.setdefault(asked, asked)

    def _default_request(self) -> list[Qos]:
        if self._wait_for.publisher:
            return []
        asked = request(self.route.qos, NO_OFFER)
        return [self._requests.setdefault(asked, asked)]

    def _pass_on(self, now: float, taken: Taken) -> None:
        """Forward the samples of known publishers."""
        mine: list[tuple[_Source, RawSample]] = []
        for asked, raw in taken:
            if not raw.valid:
                continue
            if (source := self._sender(asked, raw)) is not None:
                mine.append((source, raw))
            elif raw.publication_handle not in self._sources:
                self.counts.foreign += 1
        for source, raw in mine if len(mine) < 2 else self._newest(mine, now):
            source.has_sent, source.is_quiet = True, False
            self._send(source.outlet or self._outlet_of(source, now), raw.data, now)

    def _newest(
        self, mine: Sequence[tuple[_Source, RawSample]], now: float
    ) -> list[tuple[_Source, RawSample]]:
        """Of the samples of each publisher the newest that there is room for, in their order."""
        found, count = [], Counter[int]()
        for source, raw in reversed(mine):
            outlet = self._outlet_of(source, now)
            is_history = outlet.is_latched and now < source.new_until
            room = outlet.qos.depth if is_history else outlet.room
            count[raw.publication_handle] += 1
            if room is None or count[raw.publication_handle] <= room:
                found.append((source, raw))
        self.counts.superseded += len(mine) - len(found)
        return found[::-1]

    def _sender(self, asked: Qos, raw: RawSample) -> _Source | None:
        """The publisher of a sample; None when it is not forwarded, or not from here.

        A weaker subscription hears the stronger publishers as well; what it heard of them before
        their own one was open is not forwarded twice.
        """
        source = self._sources.get(raw.publication_handle)
        if source is None or raw.source_timestamp_ns in source.early:
            return None
        if source.asked is not asked:
            if not source.is_between:
                return None
            source.early.add(raw.source_timestamp_ns)
        return source

    def _outlet_of(self, source: _Source, now: float) -> Outlet:
        if source.outlet is None:
            alike = [
                other.endpoint.qos
                for other in self._sources.values()
                if other is not source and other.asked.durability == source.asked.durability
            ]
            if source.asked.durability == "transient_local":
                alike = []  # what lasts belongs to one publisher
            user = source.endpoint.number
            source.outlet = self._outlets.assign(user, [source.endpoint.qos, *alike], now)
            self._note(f"publishes {_kind(source.outlet.qos)}")
        return source.outlet

    def _end(self, taken: Taken) -> None:
        """Pass on what publishers have disposed, unregistered, or no longer assert to be alive."""
        for asked, raw in {(a, r.publication_handle): (a, r) for a, r in taken}.values():
            source = self._sources.get(raw.publication_handle)
            if source is not None and source.asked is asked and raw.is_disposed and source.outlet:
                source.outlet.dispose()
        for asked, raw in dict(taken).items():
            if raw.is_orphaned:
                self._silence(asked)

    def _silence(self, asked: Qos) -> None:
        """No publisher of a kind is alive: neither are those that speak for them."""
        for source in self._sources.values():
            if source.asked is asked and source.has_sent:
                source.has_sent, source.is_quiet = False, True
                self._leave_outlet(source)

    def _release(self, gone: Sequence[_Source]) -> None:
        for source in gone:
            self._leave_outlet(source)
            if self._sources.get(source.endpoint.handle) is source:
                del self._sources[source.endpoint.handle]
        for source in self._sources.values():
            source.is_between = False
        if self._sources:
            self._inlets.close_all_but({source.asked for source in self._sources.values()})

    def _leave_outlet(self, source: _Source) -> None:
        if source.outlet is not None:
            source.outlet.users.discard(source.endpoint.number)
            source.outlet = None

    def _show_a_publisher(self, now: float) -> None:
        """Let readers beyond find a publisher when there is one, before it sends anything."""
        if any(source.outlet is not None for source in self._sources.values()):
            return
        for source in self._sources.values():
            if not source.is_quiet:
                self._outlet_of(source, now)
                return
        if not self._wait_for.publisher and not self._outlets.offers:
            self._outlets.make(offer_beyond(self.route.qos, ()), now)

    def _send(self, outlet: Outlet, data: bytes, now: float) -> None:
        if self._transform is not None:
            try:
                data = self._transform(data)
            except CompressionError as problem:
                self.counts.refused += 1
                self._note(f"sample refused: {problem}")
                return
        outlet.send(data, now)

    def _lost(self, error: str) -> None:
        self._note(f"sample lost in domain {self.route.target[0]}: {error}")

    def _publishers(self) -> list[RemoteEndpoint]:
        """Publishers of the route's type, oldest first."""
        found = self._source.publications(self.route.source[1])
        return [other for other in found if other.type_name == self.read_type]

    def _can_hear(self, endpoint: RemoteEndpoint) -> bool:
        return endpoint.type_name == self.read_type and not unmet(self.route.qos, endpoint.qos)

    def _is_ready(self, found: Sequence[RemoteEndpoint], now: float) -> bool:
        if not found:
            self._found_at = None
        elif self._found_at is None:
            self._found_at = now
        if self._wait_for.publisher and (
            self._found_at is None or now - self._found_at < self.route.delay_s
        ):
            return False
        return not self._wait_for.subscription or bool(self._readers())

    def _readers(self) -> list[RemoteEndpoint]:
        """Subscriptions of the route's type in the target domain."""
        found = self._target.subscriptions(self.route.target[1])
        return [other for other in found if other.type_name == self.write_type]

    def _subscribe(self, asked: Qos) -> Subscription:
        topic = self.route.source[1]
        subscription = self._source.subscription(topic, self.read_type, asked, ignore_own=True)
        self._group.add(subscription, self)
        return subscription

    def _leave(self, subscription: Subscription) -> None:
        self._group.remove(subscription)
        subscription.close()

    def _warn(self) -> None:
        """Say once what is on either topic and cannot match; and who is not forwarded."""
        for other in self._source.publications(self.route.source[1]):
            if other.type_name != self.read_type:
                self._note(
                    f"published as {other.type_name} in domain {self.route.source[0]}, the bridge"
                    f" file has {self.read_type} ({self.route.where})"
                )
            elif policies := unmet(self.route.qos, other.qos):
                self._note(
                    f"a publisher in domain {self.route.source[0]} does not offer what the bridge"
                    f" file asks for ({self.route.where}): {'; '.join(policies)}"
                )
        offers = self._outlets.offers
        for other in self._readers() if offers else ():
            lacks = [incompatible_policies(offer, other.qos) for offer in offers]
            if all(lacks):
                self._note(
                    f"a subscription in domain {self.route.target[0]} asks for more than the"
                    f" publishers in domain {self.route.source[0]} offer: {'; '.join(lacks[0])}"
                )
        self._warn_of_others(time.monotonic())

    def _warn_of_others(self, now: float) -> None:
        """Raise an alarm when there are more publishers than the route keeps to."""
        kept = self._kept
        if kept.others == self._alarmed or now - self._alarmed_at < ALARM_S:
            return
        self._alarmed, self._alarmed_at = kept.others, now
        names = [self._name(one) for one in kept.forwarded], [self._name(o) for o in kept.others]
        (domain, topic), (to_domain, _) = self.route.source, self.route.target
        self._alarm(
            {"topic": topic, "from": domain, "to": to_domain, "kept": names[0], "others": names[1]}
        )
        if kept.others:
            who = f"{', '.join(names[0])} is forwarded" if names[0] else "nothing is forwarded"
            self._say(
                f"{self.route}: ALARM: publisher in domain {domain} that is not forwarded:"
                f" {', '.join(names[1][:4])}; {who}"
            )
        else:
            self._say(f"{self.route}: no other publisher any more")

    def _name(self, endpoint: RemoteEndpoint) -> str:
        return " ".join([endpoint.guid.hex(), self._source.node_of(endpoint)]).strip()

    def _note(self, text: str) -> None:
        """Say each line once; all anew when the route was opened again."""
        if text not in self._told and len(self._told) < _MAX_TOLD:
            self._told.add(text)
            self._say(f"{self.route}: {text}")


def _without_what_ended(asked: Qos, raw: RawSample) -> RawSample:
    """Turn a sample that was meant to last, and does not any more, into a notice of its end."""
    is_latched = asked.durability == "transient_local"
    return raw._replace(valid=False) if is_latched and not raw.is_alive else raw


def _kind(qos: Qos) -> str:
    return f"{qos.reliability} {qos.durability.replace('_', ' ')}"
