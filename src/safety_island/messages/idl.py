# SPDX-License-Identifier: Apache-2.0
"""Reader for the IDL that ROS 2 generates: modules, structs, constants, annotations."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from safety_island.messages.description import (
    Array,
    Element,
    Field,
    FieldType,
    Named,
    Primitive,
    Sequence,
    String,
    Struct,
)
from safety_island.messages.errors import IdlError

_TOKEN = re.compile(
    r"""(?P<skip>\s+|//[^\n]*|/\*.*?\*/|\#include[^\n]*)
      |(?P<word>[A-Za-z_]\w*(?:::[A-Za-z_]\w*)*)
      |(?P<number>[-+]?[\d.]+(?:[eE][-+]?\d+)?)
      |(?P<text>"(?:[^"\\]|\\.)*")
      |(?P<sign>[{}()\[\]<>;=,@])""",
    re.VERBOSE | re.DOTALL,
)
_CONSTANTS = "_Constants"
_MAX_DEPTH = 20
"""Modules in each other; ROS 2 has two or three."""


def parse_idl(text: str, source: str = "<idl>") -> list[Struct]:
    """Return the structs of one IDL file in the order in which they stand there.

    ``source`` names the file in errors. Raises IdlError for what is not understood.
    """
    return _Parser(text, source).file()


class _Parser:
    def __init__(self, text: str, source: str) -> None:
        self._source = source
        self._tokens = list(self._scan(text))
        self._at = 0
        self._structs: list[tuple[str, tuple[Field, ...]]] = []
        self._constants: dict[str, dict[str, int]] = {}

    def _scan(self, text: str) -> Iterator[tuple[str, int]]:
        place, line = 0, 1
        while place < len(text):
            match = _TOKEN.match(text, place)
            if match is None:
                raise IdlError(f"{self._source}:{line}: unexpected character {text[place]!r}")
            if match.lastgroup != "skip":
                yield match.group(), line
            line += match.group().count("\n")
            place = match.end()

    def file(self) -> list[Struct]:
        while self._at < len(self._tokens):
            self._module(())
        return [Struct(n, fields, self._constants.get(n, {})) for n, fields in self._structs]

    def _module(self, path: tuple[str, ...]) -> None:
        self._expect("module")
        path = (*path, self._next())
        if len(path) > _MAX_DEPTH:
            raise self._error(f"more than {_MAX_DEPTH} modules in each other")
        self._expect("{")
        while self._peek() != "}":
            self._skip_annotations()
            if self._peek() == "module":
                self._module(path)
            elif self._peek() == "const":
                self._constant(path)
            else:
                self._struct(path)
        self._expect("}", ";")

    def _constant(self, path: tuple[str, ...]) -> None:
        self._expect("const")
        self._next()
        name = self._next()
        self._expect("=")
        owner = "/".join(path).removesuffix(_CONSTANTS)
        self._constants.setdefault(owner, {})[name] = self._number()
        self._expect(";")

    def _struct(self, path: tuple[str, ...]) -> None:
        self._expect("struct")
        name = self._next()
        self._expect("{")
        fields = []
        while self._peek() != "}":
            fields.append(self._field())
        self._expect("}", ";")
        self._structs.append(("/".join((*path, name)), tuple(fields)))

    def _field(self) -> Field:
        default = self._skip_annotations()
        element = self._type()
        name = self._next()
        kind: FieldType = element
        if self._peek() == "[":
            if isinstance(element, Sequence):
                raise self._error("an array of sequences is not supported")
            kind = Array(element, self._bound("[", "]"))
        self._expect(";")
        return Field(name, kind, default)

    def _type(self) -> Element | Sequence:
        word = self._next()
        if word == "string":
            return String(self._bound("<", ">") if self._peek() == "<" else None)
        if word == "sequence":
            return self._sequence()
        if "::" in word:
            return Named(word.replace("::", "/"))
        try:
            return Primitive(word)
        except ValueError:
            raise self._error(f"unknown type {word!r}") from None

    def _sequence(self) -> Sequence:
        self._expect("<")
        if self._peek() == "sequence":
            raise self._error("a sequence of sequences is not supported")
        element = self._type()
        assert not isinstance(element, Sequence)
        bound = None
        if self._peek() == ",":
            self._next()
            bound = self._number()
        self._expect(">")
        return Sequence(element, bound)

    def _bound(self, opening: str, closing: str) -> int:
        self._expect(opening)
        size = self._number()
        self._expect(closing)
        return size

    def _number(self) -> int:
        word = self._next()
        try:
            return int(word)
        except ValueError:
            raise self._error(f"found {word!r}, expected a number") from None

    def _skip_annotations(self) -> float | int | bool | str | None:
        """Step over annotations; return the value of @default when there is one."""
        default = None
        while self._peek() == "@":
            self._next()
            name = self._next()
            arguments = self._arguments() if self._peek() == "(" else {}
            if name == "default":
                default = self._literal(arguments.get("value", "nothing"))
        return default

    def _arguments(self) -> dict[str, str]:
        self._expect("(")
        found: dict[str, str] = {}
        while self._peek() != ")":
            name = self._next()
            if self._peek() == "=":
                self._next()
                found[name] = self._next()
                while self._peek().startswith('"'):
                    self._next()
            if self._peek() == ",":
                self._next()
        self._expect(")")
        return found

    def _literal(self, word: str) -> float | int | bool | str:
        if word in ("TRUE", "FALSE"):
            return word == "TRUE"
        try:
            value: float | int | str = ast.literal_eval(word)
        except (ValueError, SyntaxError):
            raise self._error(f"found {word!r}, expected a value") from None
        return value

    def _peek(self) -> str:
        return self._tokens[self._at][0] if self._at < len(self._tokens) else ""

    def _next(self) -> str:
        if self._at >= len(self._tokens):
            raise self._error("the file ends too early")
        self._at += 1
        return self._tokens[self._at - 1][0]

    def _expect(self, *tokens: str) -> None:
        for token in tokens:
            found = self._next()
            if found != token:
                raise self._error(f"found {found!r}, expected {token!r}")

    def _error(self, message: str) -> IdlError:
        line = self._tokens[min(self._at, len(self._tokens)) - 1][1] if self._tokens else 1
        return IdlError(f"{self._source}:{line}: {message}")
