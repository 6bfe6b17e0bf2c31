# SPDX-License-Identifier: Apache-2.0
"""Parameter files: ROS 2's own YAML, taken apart into keys with the line where each stands."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import yaml

from safety_island.params.problem import Place, Problem
from safety_island.params.scalars import interpret
from safety_island.params.source import Source

_SECTION = "ros__parameters"

MAX_DEPTH = 20
"""Levels of maps and lists in a file; real ones have four."""


@dataclass(frozen=True)
class Entry:
    """One key of a file with its value; ``section`` is where its ``ros__parameters`` stands."""

    key: str
    value: object
    place: Place
    section: Place


@dataclass(frozen=True)
class Parsed:
    """What stands in one file, and what is wrong with it."""

    entries: tuple[Entry, ...]
    problems: tuple[Problem, ...]


class _Loader(yaml.SafeLoader):
    """Composes nodes; refuses what ROS 2 refuses too: anchors, aliases and tags."""

    depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()  # type: ignore[no-untyped-call]
        aliased = isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None
        for wrong, what in (
            (aliased, "found an anchor or alias"),
            (getattr(event, "tag", None) is not None, "found a tag"),
            (self.depth > MAX_DEPTH, f"found more than {MAX_DEPTH} levels"),
        ):
            if wrong:
                raise yaml.MarkedYAMLError(problem=what, problem_mark=event.start_mark)
        self.depth += 1
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node


@lru_cache(maxsize=64)
def parse(source: Source) -> Parsed:
    """Return every key of a file in order, nested maps joined with dots, and what is wrong.

    The answer is kept: the files of the shipped sets are asked for again and again.
    """
    try:
        root = _compose(source.text)
    except yaml.YAMLError as error:
        return Parsed((), (_syntax(source, error),))
    problems: list[Problem] = []
    entries = tuple(_sections(root, source.name, problems))
    if not entries and not problems:
        text = f"found no parameter; expected a section '/**:' with '{_SECTION}:' and keys in it"
        problems.append(Problem(Place(source.name), "", text))
    return Parsed(entries, tuple(problems))


def value_of_text(text: str) -> object:
    """Return what a text means as the value of a key, as on a command line.

    Raises yaml.YAMLError when it is no YAML.
    """
    return _value(_compose(text))


def _compose(text: str) -> Any:
    loader = _Loader(text)
    try:
        return loader.get_single_node()
    finally:
        loader.dispose()


def _syntax(source: Source, error: yaml.YAMLError) -> Problem:
    mark = getattr(error, "problem_mark", None)
    what = getattr(error, "problem", None) or getattr(error, "reason", None) or "bad YAML"
    place = Place(source.name, mark.line + 1 if mark else None)
    return Problem(place, "", f"cannot be read as YAML: {what}; expected plain keys and values")


def _sections(node: Any, name: str, problems: list[Problem]) -> Iterator[Entry]:
    """Walk the names of nodes above each ``ros__parameters``."""
    if not isinstance(node, yaml.MappingNode):
        return
    for key, child in node.value:
        place = Place(name, key.start_mark.line + 1)
        word = key.value if isinstance(key, yaml.ScalarNode) else ""
        if word == _SECTION and isinstance(child, yaml.MappingNode):
            yield from _flat(child, "", name, place, problems)
        elif word and isinstance(child, yaml.MappingNode):
            yield from _sections(child, name, problems)
        elif word == _SECTION:
            problems.append(Problem(place, word, "has no keys; expected a map of parameters"))
        else:
            text = f"stands where a node's name is expected; put it under '/**:', '{_SECTION}:'"
            problems.append(Problem(place, word, text))


def _flat(
    node: Any, prefix: str, name: str, section: Place, problems: list[Problem]
) -> Iterator[Entry]:
    """Yield the keys below one ``ros__parameters``, a nested key with the dots of ROS 2."""
    for key, child in node.value:
        place = Place(name, key.start_mark.line + 1)
        if not isinstance(key, yaml.ScalarNode):
            problems.append(Problem(place, "", "found a list or map as a key; expected a name"))
            continue
        full = f"{prefix}{key.value}"
        if isinstance(child, yaml.MappingNode) and child.value:
            yield from _flat(child, f"{full}.", name, section, problems)
        else:
            yield Entry(full, _value(child), place, section)


def _value(node: Any) -> object:
    if isinstance(node, yaml.ScalarNode):
        return interpret(node.value, quoted=node.style is not None)
    if isinstance(node, yaml.SequenceNode):
        return [_value(item) for item in node.value]
    return {} if isinstance(node, yaml.MappingNode) else None
