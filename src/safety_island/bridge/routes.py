# SPDX-License-Identifier: Apache-2.0
"""From bridge files and options to the list of routes, or the reason why there is none."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from safety_island.bridge.config_file import BridgeFile, Entry, Keep, Mode, QosWish
from safety_island.bridge.section import Where
from safety_island.dds.names import dds_topic_name
from safety_island.errors import ConfigurationError

End = tuple[int, str]
"""A domain id and an absolute topic name."""
Note = Callable[[str], None]
"""Called with one line that a user should know."""


@dataclass(frozen=True)
class Overrides:
    """What the command line sets for every entry; None leaves the file's value."""

    from_domain: int | None = None
    to_domain: int | None = None
    mode: Mode | None = None


@dataclass(frozen=True)
class Route:
    """One direction of one entry: samples of ``source`` go to ``target``."""

    source: End
    target: End
    type_name: str
    mode: Mode
    qos: QosWish
    where: Where
    keep: Keep
    delay_s: float

    def is_opposite_of(self, other: Route) -> bool:
        """Whether it leads back from the other one's target to its source.

        That is no loop: a bridge does not hear what it published itself.
        """
        return self.source == other.target and self.target == other.source

    def __str__(self) -> str:
        (from_domain, topic), (to_domain, out) = self.source, self.target
        arrow = f"domain {from_domain} -> {to_domain}"
        return f"{topic} {arrow}" if topic == out else f"{topic} {arrow} as {out}"


def plan_routes(
    files: Sequence[BridgeFile], overrides: Overrides | None = None, note: Note = lambda _: None
) -> list[Route]:
    """Return every route of all files, in order; one that stands there already is noted, once.

    Raises ConfigurationError for a domain that is missing, the same domain on both ends, two types
    for one route, or three entries and more that lead samples back to where they came from.
    """
    found: dict[tuple[End, End], Route] = {}
    for file in files:
        for entry in file.entries:
            for route in _routes_of(entry, file, overrides or Overrides()):
                first = found.setdefault((route.source, route.target), route)
                if first is not route:
                    _note_twin(route, first, note)
    routes = list(found.values())
    _refuse_loops(routes)
    return routes


def _routes_of(entry: Entry, file: BridgeFile, overrides: Overrides) -> list[Route]:
    """The route of an entry, and the other direction of a bidirectional one.

    As in ROS 2, both directions read the entry's topic and write its ``remap``.
    """
    first = _pick(entry, "from", overrides.from_domain, entry.from_domain)
    last = _pick(entry, "to", overrides.to_domain, entry.to_domain)
    if first == last:
        entry.where.refuse(
            f"topic '{entry.topic}' goes from domain {first} to domain {last}; "
            "expected two different domains"
        )
    topic = _absolute(entry, entry.topic, file.name)
    out = topic if entry.remap is None else _absolute(entry, entry.remap, file.name)
    ends = [(last, first)] if entry.reversed else [(first, last)]
    if entry.bidirectional:
        ends.append((ends[0][1], ends[0][0]))
    mode = overrides.mode or file.mode
    rest = entry.type_name, mode, entry.qos, entry.where, entry.keep, entry.delay_s
    return [Route((start, topic), (end, out), *rest) for start, end in ends]


def _pick(entry: Entry, end: str, option: int | None, given: int | None) -> int:
    value = given if option is None else option
    if value is None:
        entry.where.refuse(
            f"topic '{entry.topic}' has no '{end}_domain' and the file has no default; "
            f"add one, or give --{end}"
        )
    return value


def _absolute(entry: Entry, name: str, bridge: str) -> str:
    """Resolve a name as seen from ``/``; ``~`` stands for the bridge's name."""
    if name == "~" or name.startswith("~/"):
        name = f"/{bridge}{name[1:]}"
    elif not name.startswith("/"):
        name = f"/{name}"
    try:
        dds_topic_name(name)
    except ConfigurationError as problem:
        entry.where.refuse(str(problem))
    return name


def _note_twin(route: Route, first: Route, note: Note) -> None:
    already = f"{route} is already forwarded by the entry at {first.where}"
    if route.type_name != first.type_name:
        route.where.refuse(f"{already}, as {first.type_name} instead of {route.type_name}")
    note(f"{route.where}: {already}; this entry is ignored")


def _refuse_loops(routes: Sequence[Route]) -> None:
    """Refuse a way back to a route's source that is not just its opposite direction."""
    for route in reversed(routes):
        others = [other for other in routes if not other.is_opposite_of(route)]
        back = _way(route.target, route.source, others)
        if back is not None:
            steps = ", ".join(f"{step} ({step.where})" for step in back)
            route.where.refuse(
                f"{route} closes a loop with {steps}; a bridge does not forward what it published"
                " itself, and two bridges would send samples round for ever"
            )


def _way(start: End, goal: End, routes: Sequence[Route]) -> list[Route] | None:
    """Find routes that lead from one end to another, breadth first; None when there are none."""
    reached: dict[End, list[Route]] = {start: []}
    queue = [start]
    for place in queue:
        for route in routes:
            if route.source == place and route.target not in reached:
                reached[route.target] = [*reached[place], route]
                queue.append(route.target)
    return reached.get(goal)
