"""The bridge file in the schema of ROS 2's ``domain_bridge``, checked to the last key.

The same topic may stand in ``topics`` several times: each entry counts.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Literal, cast

import yaml

from safety_island.bridge.section import Section, Where, load
from safety_island.dds.config import MAX_DOMAIN_ID
from safety_island.dds.qos import Durability, History, Liveliness, Reliability

DEFAULT_NAME = "domain_bridge"
DEFAULT_DEPTH = 10
MAX_DEPTH = 100_000
AUTO: Literal["auto"] = "auto"
"""A duration that is taken from the publishers."""

Mode = Literal["normal", "compress", "decompress"]
MODES: tuple[Mode, ...] = ("normal", "compress", "decompress")

_TOP = ("name", "from_domain", "to_domain", "mode", "topics")
_TOPIC = ("type", "from_domain", "to_domain", "remap", "bidirectional", "reversed", "qos")
_QOS = (
    "reliability", "durability", "history", "depth", "deadline", "lifespan", "liveliness",
    "liveliness_lease_duration",
)  # fmt: skip
_TYPE = re.compile(r"[A-Za-z]\w*/msg/[A-Za-z]\w*", re.ASCII)
_NODE_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_NS_MAX = 2**63 - 1


@dataclass(frozen=True)
class QosWish:
    """What an entry asks for; None: match the publishers (durations: infinite). Times in ns."""

    reliability: Reliability | None = None
    durability: Durability | None = None
    history: History = "keep_last"
    depth: int = DEFAULT_DEPTH
    deadline: int | Literal["auto"] | None = None
    lifespan: int | Literal["auto"] | None = None
    liveliness: Liveliness | None = None
    lease: int | None = None


@dataclass(frozen=True)
class Entry:
    """One entry of ``topics`` as it stands in the file; domains None where none was given."""

    topic: str
    type_name: str
    from_domain: int | None
    to_domain: int | None
    remap: str | None
    bidirectional: bool
    reversed: bool
    qos: QosWish
    where: Where


@dataclass(frozen=True)
class BridgeFile:
    """One file."""

    path: str
    name: str
    mode: Mode
    entries: tuple[Entry, ...]


def read_bridge_file(path: str) -> BridgeFile:
    """Read a bridge file. Raises ConfigurationError that names file, line and what is allowed."""
    top = Section(path, load(path), "the bridge file")
    top.check_keys(_TOP)
    name = top.text("name")
    name = DEFAULT_NAME if name is None else name
    if not _NODE_NAME.fullmatch(name):
        top.place("name").refuse(f"name is '{name}', expected letters, digits and underscores")
    mode = cast(Mode, top.choice("mode", MODES) or "normal")
    defaults = _domain(top, "from_domain"), _domain(top, "to_domain")
    entries = tuple(
        _entry(path, key, where, node, defaults) for key, where, node in _topics(top).entries()
    )
    return BridgeFile(path, name, mode, entries)


def _topics(top: Section) -> Section:
    node = top.node("topics")
    if node is None:
        top.where.refuse("no 'topics' in the bridge file: there is nothing to forward")
    topics = Section(top.path, node, "'topics'")
    if not any(True for _ in topics.entries()):
        topics.where.refuse("'topics' is empty: there is nothing to forward")
    return topics


def _entry(
    path: str, topic: str, where: Where, node: yaml.Node, defaults: tuple[int | None, int | None]
) -> Entry:
    section = Section(path, node, f"topic '{topic}'")
    section.check_keys(_TOPIC)
    type_name = section.text("type")
    if type_name is None:
        where.refuse(f"topic '{topic}' has no 'type', expected for example std_msgs/msg/String")
    if not _TYPE.fullmatch(type_name):
        section.place("type").refuse(f"type is '{type_name}', expected package/msg/Name")
    given = _domain(section, "from_domain"), _domain(section, "to_domain")
    return Entry(
        topic=topic,
        type_name=type_name,
        from_domain=defaults[0] if given[0] is None else given[0],
        to_domain=defaults[1] if given[1] is None else given[1],
        remap=section.text("remap"),
        bidirectional=section.flag("bidirectional") or False,
        reversed=section.flag("reversed") or False,
        qos=_qos(path, section.node("qos"), topic),
        where=where,
    )


def _domain(section: Section, key: str) -> int | None:
    return section.number(key, 0, MAX_DOMAIN_ID, "a DDS domain id")


def _qos(path: str, node: yaml.Node | None, topic: str) -> QosWish:
    if node is None:
        return QosWish()
    section = Section(path, node, f"'qos' of topic '{topic}'")
    section.check_keys(_QOS)
    chosen: dict[str, Any] = {
        "reliability": section.choice("reliability", ("reliable", "best_effort")),
        "durability": section.choice("durability", ("volatile", "transient_local")),
        "history": section.choice("history", ("keep_last", "keep_all")) or "keep_last",
        "liveliness": section.choice("liveliness", ("automatic", "manual_by_topic")),
    }
    depth = section.number("depth", 1, MAX_DEPTH, "samples to keep")
    return QosWish(
        depth=DEFAULT_DEPTH if depth is None else depth,
        deadline=_duration(section, "deadline"),
        lifespan=_duration(section, "lifespan"),
        lease=_nanoseconds(section, "liveliness_lease_duration"),
        **chosen,
    )


def _duration(section: Section, key: str) -> int | Literal["auto"] | None:
    """A duration [ns], AUTO, or None for infinite."""
    node = section.node(key)
    if isinstance(node, yaml.ScalarNode) and node.value == AUTO:
        return AUTO
    return _nanoseconds(section, key, " or 'auto'")


def _nanoseconds(section: Section, key: str, more: str = "") -> int | None:
    """A duration [ns]; negative is infinite, and so is 0, as in ROS 2."""
    meaning = f"nanoseconds (negative: infinite){more}"
    value = section.number(key, -_NS_MAX, _NS_MAX, meaning)
    return value if value is not None and value > 0 else None
