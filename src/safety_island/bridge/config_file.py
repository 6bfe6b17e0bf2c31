# SPDX-License-Identifier: Apache-2.0
"""The bridge file in the schema of ROS 2's ``domain_bridge``, checked to the last key.

The same topic may stand in ``topics`` several times: each entry counts. Three keys of a topic are
ours: ``publisher``, ``second_publisher`` and ``delay``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Literal, cast

import yaml

from safety_island.bridge.section import Section, Where, is_empty, load
from safety_island.dds.config import MAX_DOMAIN_ID
from safety_island.dds.qos import Durability, History, Liveliness, Reliability

DEFAULT_NAME = "domain_bridge"
MAX_DEPTH = 100_000
SYSTEM_DEPTH = 1
"""Depth that ROS 2's CycloneDDS layer takes for 0, its "system default"."""
MAX_DELAY_MS = 60_000
AUTO: Literal["auto"] = "auto"
"""A duration that is taken from the publishers."""

Mode = Literal["normal", "compress", "decompress"]
MODES: tuple[Mode, ...] = ("normal", "compress", "decompress")
SecondPublisher = Literal["forward", "keep_first", "silent"]
SECOND_PUBLISHER: tuple[SecondPublisher, ...] = ("forward", "keep_first", "silent")

_NOT_BRIDGED = ("services", "actions")
_TOP = ("name", "from_domain", "to_domain", "mode", "topics", *_NOT_BRIDGED)
_TOPIC = (
    "type", "from_domain", "to_domain", "remap", "bidirectional", "reversed", "qos", "publisher",
    "second_publisher", "delay",
)  # fmt: skip
_QOS = (
    "reliability", "durability", "history", "depth", "deadline", "lifespan", "liveliness",
    "liveliness_lease_duration",
)  # fmt: skip
_TYPE = re.compile(r"[A-Za-z]\w*/msg/[A-Za-z]\w*", re.ASCII)
_NODE_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_PUBLISHER = re.compile(r"(/[A-Za-z_]\w*)+|([0-9A-Fa-f]{2}[.:| ]?){16}([.:| ]?00)*", re.ASCII)
_LIVELINESS = ("automatic", "manual_by_topic", "system_default")
_NS_MAX = 2**63 - 1


@dataclass(frozen=True)
class QosWish:
    """What an entry asks for; None: match the publishers (durations: infinite). Times in ns."""

    reliability: Reliability | None = None
    durability: Durability | None = None
    history: History | None = None
    depth: int | None = None
    deadline: int | Literal["auto"] | None = None
    lifespan: int | Literal["auto"] | None = None
    liveliness: Liveliness | None = None
    lease: int | None = None


@dataclass(frozen=True)
class Keep:
    """To which publisher an entry keeps.

    ``publisher`` is a node name (``/a/b``) or a GUID in 32 hexadecimal digits, empty for any;
    ``second`` says what to do about more than one.
    """

    publisher: str = ""
    second: SecondPublisher = "forward"


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
    keep: Keep
    delay_s: float
    where: Where


@dataclass(frozen=True)
class BridgeFile:
    """One file."""

    path: str
    name: str
    mode: Mode
    entries: tuple[Entry, ...]
    notes: tuple[str, ...] = ()
    """What a user should know: what stands in the file and is not bridged."""


def read_bridge_file(path: str) -> BridgeFile:
    """Read a bridge file. Raises ConfigurationError that names file, line and what is allowed."""
    node = load(path)
    if node is None:
        return BridgeFile(path, DEFAULT_NAME, "normal", (), (_nothing(path),))
    top = Section(path, node, "the bridge file")
    top.check_keys(_TOP)
    name = top.text("name")
    name = DEFAULT_NAME if name is None else name
    if not _NODE_NAME.fullmatch(name):
        top.place("name").refuse(f"name is '{name}', expected letters, digits and underscores")
    mode = cast(Mode, top.choice("mode", MODES) or "normal")
    defaults = _domain(top, "from_domain"), _domain(top, "to_domain")
    topics = _topics(top)
    found = () if topics is None else topics.entries()
    entries = tuple(_entry(path, key, where, entry, defaults) for key, where, entry in found)
    notes = [
        f"{top.place(key)}: {key} are not bridged, only topics are"
        for key in _NOT_BRIDGED
        if top.node(key) is not None
    ]
    notes += [] if entries else [_nothing(path)]
    return BridgeFile(path, name, mode, entries, tuple(notes))


def _nothing(path: str) -> str:
    return f"{path}: no topics in this file, it forwards nothing"


def _topics(top: Section) -> Section | None:
    node = top.node("topics")
    if node is None or is_empty(node):
        return None
    return Section(top.path, node, "'topics'")


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
        remap=section.text("remap") or None,
        bidirectional=section.flag("bidirectional") or False,
        reversed=section.flag("reversed") or False,
        qos=_qos(path, section.node("qos"), topic),
        keep=_keep(section),
        delay_s=(section.number("delay", 0, MAX_DELAY_MS, "milliseconds") or 0) / 1000.0,
        where=where,
    )


def _keep(section: Section) -> Keep:
    publisher = section.text("publisher") or ""
    if publisher and not _PUBLISHER.fullmatch(publisher):
        section.place("publisher").refuse(
            f"publisher is '{publisher}', expected a node name such as /safety_island, or a GUID"
            " of 32 hexadecimal digits"
        )
    if publisher and not publisher.startswith("/"):
        publisher = re.sub("[^0-9a-f]", "", publisher.lower())[:32]
    second = cast(SecondPublisher | None, section.choice("second_publisher", SECOND_PUBLISHER))
    return Keep(publisher, second or "forward")


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
        "history": section.choice("history", ("keep_last", "keep_all")),
        "liveliness": section.choice("liveliness", _LIVELINESS),
    }
    if chosen["liveliness"] == "system_default":
        chosen["liveliness"] = None
    depth = section.number("depth", 0, MAX_DEPTH, "samples to keep")
    return QosWish(
        depth=SYSTEM_DEPTH if depth == 0 else depth,
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
