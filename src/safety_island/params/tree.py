"""Parameter files: ROS 2's own YAML, taken apart into keys with the line where each stands."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import yaml

from safety_island.params.problem import Place, Problem
from safety_island.params.scalars import interpret

_SECTION = "ros__parameters"


@dataclass(frozen=True)
class Source:
    """The text of one file, and the name under which errors speak of it."""

    name: str
    text: str


@dataclass(frozen=True)
class Entry:
    """One key of a file with its value; ``section`` is where its ``ros__parameters`` stands."""

    key: str
    value: object
    place: Place
    section: Place


class _Loader(yaml.SafeLoader):
    """Composes nodes; refuses what ROS 2 refuses too: anchors, aliases and tags."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()  # type: ignore[no-untyped-call]
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None:
            raise yaml.MarkedYAMLError(problem="anchors and aliases", problem_mark=event.start_mark)
        if getattr(event, "tag", None) is not None:
            raise yaml.MarkedYAMLError(problem="tags", problem_mark=event.start_mark)
        return super().compose_node(parent, index)


def entries(source: Source, problems: list[Problem]) -> list[Entry]:
    """Return every key of a file in order, nested maps joined with dots; append what is wrong."""
    try:
        root = _compose(source.text)
    except yaml.YAMLError as error:
        problems.append(_syntax(source, error))
        return []
    except RecursionError:
        problems.append(Problem(Place(source.name), "", "found YAML that is nested too deeply"))
        return []
    before = len(problems)
    result = list(_sections(root, source.name, problems))
    if not result and len(problems) == before:
        text = f"found no parameter; expected a section '/**:' with '{_SECTION}:' and keys in it"
        problems.append(Problem(Place(source.name), "", text))
    return result


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
        if key.value == _SECTION and isinstance(child, yaml.MappingNode):
            yield from _flat(child, "", name, place, problems)
        elif isinstance(child, yaml.MappingNode) and isinstance(key, yaml.ScalarNode):
            yield from _sections(child, name, problems)
        else:
            text = f"stands where a node's name is expected; put it under '/**:', '{_SECTION}:'"
            if key.value == _SECTION:
                text = "has no keys; expected a map of parameters"
            problems.append(Problem(place, str(key.value), text))


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
