"""From bridge files and options to the list of routes, or the reason why there is none."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from safety_island.bridge.config_file import BridgeFile, Entry, Mode, QosWish
from safety_island.bridge.section import Where
from safety_island.dds.names import dds_topic_name
from safety_island.errors import ConfigurationError

End = tuple[int, str]
"""A domain id and an absolute topic name."""


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
    entry: int
    """Number of the entry; both directions of a bidirectional entry share it."""

    def __str__(self) -> str:
        (from_domain, topic), (to_domain, out) = self.source, self.target
        arrow = f"domain {from_domain} -> {to_domain}"
        return f"{topic} {arrow}" if topic == out else f"{topic} {arrow} as {out}"


def plan_routes(files: Sequence[BridgeFile], overrides: Overrides | None = None) -> list[Route]:
    """Return every route of all files, in order.

    Raises ConfigurationError for a domain that is missing, the same domain on both ends, two equal
    routes, or entries that together lead samples back to where they came from.
    """
    routes: list[Route] = []
    for file in files:
        for entry in file.entries:
            routes += _routes_of(entry, len(routes), file, overrides or Overrides())
    _refuse_twins(routes)
    _refuse_loops(routes)
    return routes


def _routes_of(entry: Entry, number: int, file: BridgeFile, overrides: Overrides) -> list[Route]:
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
    return [
        Route((start, topic), (end, out), entry.type_name, mode, entry.qos, entry.where, number)
        for start, end in ends
    ]


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


def _refuse_twins(routes: Iterable[Route]) -> None:
    seen: dict[tuple[End, End], Route] = {}
    for route in routes:
        first = seen.setdefault((route.source, route.target), route)
        if first is not route:
            route.where.refuse(f"{route} is already forwarded by the entry at {first.where}")


def _refuse_loops(routes: Sequence[Route]) -> None:
    """Refuse a way back to a route's source over other entries.

    The two directions of one bidirectional entry are no loop: neither hears the other.
    """
    for route in reversed(routes):
        back = _way(route.target, route.source, [r for r in routes if r.entry != route.entry])
        if back is not None:
            steps = ", ".join(f"{step} ({step.where})" for step in back)
            hint = "; for both directions use one entry with 'bidirectional: true'"
            route.where.refuse(
                f"{route} closes a loop with {steps}; samples would go round for ever"
                + (hint if len(back) == 1 else "")
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
