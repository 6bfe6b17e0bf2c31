"""A map in a YAML file whose every complaint names file and line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from difflib import get_close_matches
from pathlib import Path
from typing import NoReturn, TypeVar

import yaml

from safety_island.errors import ConfigurationError
from safety_island.text_file import UnreadableError, read_text

_TAGS = {
    "str": "tag:yaml.org,2002:str",
    "int": "tag:yaml.org,2002:int",
    "bool": "tag:yaml.org,2002:bool",
}
_KINDS: dict[type[yaml.Node], str] = {yaml.MappingNode: "a map", yaml.SequenceNode: "a list"}
T = TypeVar("T", int, str, bool)


class Where:
    """A place in a file; ``str`` gives ``file:line``."""

    def __init__(self, path: str, node: yaml.Node) -> None:
        self._text = f"{path}:{node.start_mark.line + 1}"

    def __str__(self) -> str:
        return self._text

    def refuse(self, problem: str) -> NoReturn:
        """Raise ConfigurationError for this place."""
        raise ConfigurationError(f"{self}: {problem}")


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
                near = get_close_matches(name, allowed, n=1)
                hint = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(allowed)}"
                where.refuse(f"unknown key '{name}' in {self.title}; {hint}")
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
        """The value as a string."""
        return self._scalar(key, "str", "a string", str)

    def flag(self, key: str) -> bool | None:
        """The value as a boolean."""
        return self._scalar(key, "bool", "true or false", bool)

    def number(self, key: str, low: int, high: int, meaning: str) -> int | None:
        """The value as an integer from ``low`` to ``high``."""
        expected = f"{meaning}: a whole number from {low} to {high}"
        value = self._scalar(key, "int", expected, int)
        if value is not None and not low <= value <= high:
            node = self.node(key)  # as it is written: 5000 digits cannot be
            assert node is not None
            self.place(key).refuse(f"{key} is {node.value}, expected {expected}")
        return value

    def choice(self, key: str, choices: tuple[str, ...]) -> str | None:
        """The value as one of several words."""
        value = self.text(key)
        if value is not None and value not in choices:
            near = get_close_matches(value, choices, n=1)
            hint = f"; did you mean '{near[0]}'?" if near else ""
            expected = " or ".join(choices)
            self.place(key).refuse(f"{key} is '{value}', expected {expected}{hint}")
        return value

    def _scalar(self, key: str, tag: str, expected: str, kind: type[T]) -> T | None:
        node = self.node(key)
        if node is None:
            return None
        if not isinstance(node, yaml.ScalarNode) or node.tag != _TAGS[tag]:
            self.place(key).refuse(f"{key} is {describe(node)}, expected {expected}")
        try:
            value = yaml.SafeLoader("").construct_object(node)
        except (ValueError, LookupError):  # of its own words for numbers: 0b_, 5000 digits
            self.place(key).refuse(f"{key} is {describe(node)}, expected {expected}")
        assert isinstance(value, kind)
        return value


def load(path: str) -> yaml.Node:
    """Return the one document of a file. Raises ConfigurationError when it is no YAML."""
    try:
        node = yaml.compose(read_text(Path(path)), Loader=yaml.SafeLoader)
    except UnreadableError as why:
        raise ConfigurationError(f"cannot read bridge file {path}: {why}") from None
    except RecursionError:
        raise ConfigurationError(f"{path}: lists or maps too deep, expected five levels") from None
    except yaml.YAMLError as problem:
        raise ConfigurationError(f"{path}:{_line(problem)}: not YAML: {_reason(problem)}") from None
    if node is None:
        raise ConfigurationError(f"{path}:1: the file is empty, expected 'topics:' and its entries")
    return node


def describe(node: yaml.Node) -> str:
    """Say in words what stands in a file."""
    if not isinstance(node, yaml.ScalarNode):
        return _KINDS.get(type(node), "something else")
    if node.tag.endswith(":null"):
        return "empty"
    return f"'{node.value}'"


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
