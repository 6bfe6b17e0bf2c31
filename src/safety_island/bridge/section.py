# SPDX-License-Identifier: Apache-2.0
"""A map in a YAML file whose every complaint names file and line."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NoReturn

import yaml

from safety_island.errors import ConfigurationError
from safety_island.text_file import UnreadableError, read_text
from safety_island.words import did_you_mean

_SWITCH = {
    **dict.fromkeys(("true", "yes", "on", "y"), True),
    **dict.fromkeys(("false", "no", "off", "n"), False),
}
"""The words that ROS 2's program takes, quoted or not, in any case."""
_WHOLE_NUMBER = re.compile(r"[+-]?[0-9]{1,20}", re.ASCII)
MAX_NESTING = 32
"""Levels of maps and lists; the deepest bridge file has five."""
MAX_SHOWN = 60
_KINDS: dict[type[yaml.Node], str] = {yaml.MappingNode: "a map", yaml.SequenceNode: "a list"}


class Where:
    """A place in a file; ``str`` gives ``file:line``."""

    def __init__(self, path: str, node: yaml.Node) -> None:
        self._text = f"{path}:{node.start_mark.line + 1}"

    def __str__(self) -> str:
        return self._text

    def refuse(self, problem: str) -> NoReturn:
        """Raise ConfigurationError for this place, in one line."""
        raise ConfigurationError(f"{self}: {' '.join(problem.split())}")


class Section:
    """A map read key by key; ``title`` says in messages what it describes."""

    def __init__(self, path: str, node: yaml.Node, title: str) -> None:
        self.path, self.title = path, title
        self.where = Where(path, node)
        if not isinstance(node, yaml.MappingNode):
            self.where.refuse(f"{title} is {describe(node)}, expected a map of keys and values")
        self._pairs = [(_key(path, key), key, value) for key, value in node.value]

    def check_keys(self, known: Iterable[str]) -> None:
        """Refuse a key that is not known, with the nearest that is, and a key that stands twice."""
        allowed, seen = list(known), dict[str, Where]()
        for name, key, _ in self._pairs:
            where = Where(self.path, key)
            if name not in allowed:
                hint = did_you_mean(name, allowed) or f"; known: {', '.join(allowed)}"
                where.refuse(f"unknown key '{name}' in {self.title}{hint}")
            if name in seen:
                where.refuse(f"key '{name}' stands twice in {self.title}, first at {seen[name]}")
            seen[name] = where

    def entries(self) -> Iterator[tuple[str, Where, yaml.Node]]:
        """Every key with its place and its value, repeated keys included."""
        for name, key, value in self._pairs:
            yield name, Where(self.path, key), value

    def node(self, key: str) -> yaml.Node | None:
        """The value of a key as it stands; None when the key is absent."""
        return next((value for name, _, value in self._pairs if name == key), None)

    def place(self, key: str) -> Where:
        """Where the value of a key stands; the section itself when the key is absent."""
        node = self.node(key)
        return self.where if node is None else Where(self.path, node)

    def text(self, key: str) -> str | None:
        """The value as a string, whether it is quoted or not."""
        return self._scalar(key, "a string")

    def flag(self, key: str) -> bool | None:
        """The value as a boolean."""
        expected = "true or false"
        value = self._scalar(key, expected)
        if value is None:
            return None
        if value.lower() not in _SWITCH:
            self._refuse_value(key, expected)
        return _SWITCH[value.lower()]

    def number(self, key: str, low: int, high: int, meaning: str) -> int | None:
        """The value as an integer from ``low`` to ``high``."""
        expected = f"{meaning}: a whole number from {low} to {high}"
        value = self._scalar(key, expected)
        if value is None:
            return None
        if not _WHOLE_NUMBER.fullmatch(value) or not low <= int(value) <= high:
            self._refuse_value(key, expected)
        return int(value)

    def choice(self, key: str, choices: tuple[str, ...]) -> str | None:
        """The value as one of several words."""
        value = self.text(key)
        if value is not None and value not in choices:
            hint = did_you_mean(value, choices)
            self._refuse_value(key, f"{' or '.join(choices)}{hint}")
        return value

    def _scalar(self, key: str, expected: str) -> str | None:
        node = self.node(key)
        if node is None:
            return None
        if not isinstance(node, yaml.ScalarNode) or is_empty(node):
            self._refuse_value(key, expected)
        return str(node.value)

    def _refuse_value(self, key: str, expected: str) -> NoReturn:
        node = self.node(key)
        assert node is not None
        self.place(key).refuse(f"{key} is {describe(node)}, expected {expected}")


def load(path: str) -> yaml.Node | None:
    """Return the one document of a file, None when there is none.

    Raises ConfigurationError when it is no YAML.
    """
    try:
        text = read_text(Path(path))
        _check_nesting(path, text)
        node: yaml.Node | None = yaml.compose(text, Loader=yaml.SafeLoader)
    except UnreadableError as why:
        raise ConfigurationError(f"cannot read bridge file {path}: {why}") from None
    except yaml.YAMLError as problem:
        raise ConfigurationError(f"{path}:{_line(problem)}: not YAML: {_reason(problem)}") from None
    return node


def is_empty(node: yaml.Node) -> bool:
    """Whether nothing stands behind a key."""
    return isinstance(node, yaml.ScalarNode) and bool(node.tag.endswith(":null"))


def describe(node: yaml.Node) -> str:
    """Say in words what stands in a file."""
    if not isinstance(node, yaml.ScalarNode):
        return _KINDS.get(type(node), "something else")
    if is_empty(node):
        return "empty"
    value = str(node.value)
    return f"'{value}'" if len(value) <= MAX_SHOWN else f"'{value[:MAX_SHOWN]}' and more"


def _check_nesting(path: str, text: str) -> None:
    """Refuse what would be too deep for the recursion of PyYAML's composer."""
    depth = 0
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if depth > MAX_NESTING:
            mark = event.start_mark
            raise ConfigurationError(
                f"{path}:{1 if mark is None else mark.line + 1}: more than {MAX_NESTING} levels of"
                " lists and maps, expected a bridge file, which has five"
            )


def _key(path: str, node: yaml.Node) -> str:
    if not isinstance(node, yaml.ScalarNode):
        Where(path, node).refuse(f"a key is {describe(node)}, expected a word")
    return str(node.value)


def _line(problem: yaml.YAMLError) -> int:
    mark = getattr(problem, "problem_mark", None)
    return 1 if mark is None else mark.line + 1


def _reason(problem: yaml.YAMLError) -> str:
    reason = getattr(problem, "problem", None) or str(problem)
    return " ".join(str(reason).split())
